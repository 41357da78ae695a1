// What a job does, by the kind of its folder. Files are passed as they are; the package decodes them in its workers.
import { readFile } from "node:fs/promises";
import { readCase, readScene } from "sim3align/formats";

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

/**
 * Reads the file of a part, whatever its format, if there is one: "mask" is mask.png.
 * @param {Folder} folder
 * @param {string} part
 */
async function optional({ path, names }, part) {
  const name = names.find((candidate) => candidate.startsWith(`${part}.`));
  return name === undefined ? undefined : readFile(`${path}/${name}`);
}

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
   * One object through all frames, of which only one is in memory. The first one has a mask.
   * @param {Aligner} aligner
   * @param {Folder} folder
   * @param {object} options of `track`
   */
  async video(aligner, folder, options) {
    const mesh = await optional(folder, "mesh");
    if (mesh === undefined) throw new Error(`no mesh in ${folder.path}`);
    const tracker = await aligner.track(mesh, options);
    try {
      const frames = [];
      const names = new Set(folder.names.flatMap((name) => /^(frame_[^/]+)\//.exec(name)?.[1] ?? []));
      for (const name of names) {
        const [depth, cameraFile, mask, image] = await Promise.all(
          ["depth", "camera", "mask", "rgb"].map((part) => optional(folder, `${name}/${part}`)),
        );
        if (depth === undefined) throw new Error(`no depth in ${folder.path}/${name}`);
        const camera = cameraFile === undefined ? {} : { cameraFile };
        const tracked = await tracker.next({ depth, ...camera, mask, image });
        frames.push({ name, state: tracked.state, ...poseOf(tracked) });
      }
      return { scale: frames.at(-1)?.scale, frames };
    } finally {
      tracker.dispose();
    }
  },
};
