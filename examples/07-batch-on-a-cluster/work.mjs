// What a job does, by the kind of its folder. Files are passed as they are; the package decodes them in its workers.
import { readFile } from "node:fs/promises";
import { Sim3AlignError } from "sim3align";
import { readCase, readFrames, readScene } from "sim3align/formats";

/**
 * @typedef {import("sim3align").Aligner} Aligner
 * @typedef {object} Folder
 * @property {string} path
 * @property {string[]} names its input files, relative to it
 */

/**
 * The files of a folder by name, each read when it is needed.
 * @param {Folder} folder
 */
const filesOf = ({ path, names }) => Object.fromEntries(names.map((name) => [name, () => readFile(`${path}/${name}`)]));

/** Codes of errors of the environment, for which a retry may succeed. All other codes are errors of the input. */
const retryable = new Set(["WORKER_FAILED", "NOT_INITIALISED", "INTERNAL"]);

/** @param {unknown} error @returns {error is Sim3AlignError} whether the input is at fault, so that no retry can succeed */
export const isOfInput = (error) => error instanceof Sim3AlignError && !retryable.has(error.code);

/** @param {import("sim3align").Sim3 & { confidence: number }} pose */
const poseOf = ({ matrix, scale, confidence }) => ({ matrix, scale, confidence });

export const perform = {
  /**
   * One object in one view.
   * @param {Aligner} aligner
   * @param {Folder} folder
   * @param {object} options of `align`
   */
  async case(aligner, folder, options) {
    const { input } = await readCase(filesOf(folder));
    const result = await aligner.align(input, options);
    const { alternatives, metrics, warnings } = result;
    return { ...poseOf(result), alternatives: alternatives.length, metrics, warnings };
  },

  /**
   * All objects of a view together. An object that fails has its code; the others have their poses.
   * @param {Aligner} aligner
   * @param {Folder} folder
   * @param {object} options of `alignScene`
   */
  async scene(aligner, folder, options) {
    const { input } = await readScene(filesOf(folder));
    const found = await aligner.alignScene(input, options);
    return {
      support: found.support,
      objects: found.objects.map((object) => {
        const { name, error } = object;
        return error === undefined ? { name, ...poseOf(object), contact: object.contact } : { name, error: error.code };
      }),
    };
  },

  /**
   * One object through all frames, of which only one is in memory. The first one has a mask. A frame that fails has its code.
   * @param {Aligner} aligner
   * @param {Folder} folder
   * @param {object} options of `track`
   */
  async video(aligner, folder, options) {
    const { mesh, names, read } = await readFrames(filesOf(folder));
    if (names.length === 0) return this.case(aligner, folder, options);
    const tracker = await aligner.track(mesh, options);
    try {
      /** @type {object[]} */
      const frames = [];
      /** @type {Error[]} */
      const errors = [];
      /** @type {number | undefined} */
      let scale;
      for (const name of names) {
        try {
          const { cameraToWorld: _, ...view } = (await read(name)).input;
          const tracked = await tracker.next(view);
          frames.push({ name, state: tracked.state, ...poseOf(tracked) });
          scale = tracked.scale;
        } catch (error) {
          if (!isOfInput(error)) throw error;
          frames.push({ name, error: error.code });
          errors.push(error);
        }
      }
      if (errors.length === names.length) throw errors[0];
      return { scale, frames };
    } finally {
      tracker.dispose();
    }
  },
};
