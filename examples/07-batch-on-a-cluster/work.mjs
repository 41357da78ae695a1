// What a job does, by the kind of its folder. Files are passed as they are; the package decodes them in its workers.
import { readFile } from "node:fs/promises";

/**
 * @typedef {import("sim3align").Aligner} Aligner
 * @typedef {object} Folder
 * @property {string} path
 * @property {string[]} names its input files, relative to it
 */

/**
 * Reads the file of a part, whatever its format, if there is one: "mask" is mask.png.
 * @param {Folder} folder
 * @param {string} part
 */
async function optional({ path, names }, part) {
  const name = names.find((candidate) => candidate.startsWith(`${part}.`));
  return name === undefined ? undefined : readFile(`${path}/${name}`);
}

/**
 * @param {Folder} folder
 * @param {string} part
 */
async function required(folder, part) {
  const bytes = await optional(folder, part);
  if (bytes === undefined) throw new Error(`no ${part} in ${folder.path}`);
  return bytes;
}

/**
 * Depth, camera and, if there is one, the photo.
 * @param {Folder} folder
 * @param {string} [prefix] "frame_00/" for those of a frame
 */
async function viewOf(folder, prefix = "") {
  const [depth, cameraFile, image] = await Promise.all([
    required(folder, `${prefix}depth`),
    required(folder, `${prefix}camera`),
    optional(folder, `${prefix}rgb`),
  ]);
  return { depth, cameraFile, ...(image === undefined ? {} : { image }) };
}

/** @param {import("sim3align").Sim3 & { confidence: number }} pose */
const poseOf = ({ matrix, scale, confidence }) => ({ matrix, scale, confidence });

/**
 * The names of the folders at some depth below a folder.
 * @param {Folder} folder
 * @param {RegExp} pattern whose first group is the name
 */
const foldersIn = ({ names }, pattern) => [...new Set(names.flatMap((name) => pattern.exec(name)?.[1] ?? []))];

export const perform = {
  /**
   * One object in one view.
   * @param {Aligner} aligner
   * @param {Folder} folder
   * @param {object} options of `align`
   */
  async case(aligner, folder, options) {
    const [view, mask, mesh] = await Promise.all([viewOf(folder), required(folder, "mask"), required(folder, "mesh")]);
    const result = await aligner.align({ ...view, mask, mesh }, options);
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
    const objects = await Promise.all(
      foldersIn(folder, /^objects\/([^/]+)\//).map(async (name) => {
        const [mask, mesh] = await Promise.all(
          ["mask", "mesh"].map((part) => required(folder, `objects/${name}/${part}`)),
        );
        return { name, mask, mesh };
      }),
    );
    const found = await aligner.alignScene({ ...(await viewOf(folder)), objects }, options);
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
    const tracker = await aligner.track(await required(folder, "mesh"), options);
    try {
      const frames = [];
      for (const name of foldersIn(folder, /^(frame_[^/]+)\//)) {
        const mask = await optional(folder, `${name}/mask`);
        const frame = { ...(await viewOf(folder, `${name}/`)), ...(mask === undefined ? {} : { mask }) };
        const tracked = await tracker.next(frame);
        frames.push({ name, state: tracked.state, ...poseOf(tracked) });
      }
      return { scale: frames.at(-1)?.scale, frames };
    } finally {
      tracker.dispose();
    }
  },
};
