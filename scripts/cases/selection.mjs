/** Which objects of a dataset become cases. The same dataset and the same numbers select the same objects. */
import { compiledModule } from "../bench/inputs.mjs";

/**
 * An instance of an object in an image: `place` is its place in `scene_gt.json`.
 * @typedef {{ sceneId: number, imageId: number, objectId: number, place: number, visible: number }} Selected
 */

/**
 * @typedef {object} Selection
 * @property {number} images images of each scene, evenly spread over those that have targets
 * @property {number} visible least visible fraction of an object
 */

/** The selection in words, for the files that are made of it. @param {Selection} selection */
export const selectionText = ({ images, visible }) =>
  `${images} images of each scene, evenly spread over those with targets; targets of which at least ${100 * visible} % are visible`;

/**
 * @param {any} dataset a `BopDataset` of the package
 * @param {Selection} selection
 * @returns {Promise<Selected[]>} in the order of scenes, images and objects
 */
export async function select(dataset, { images, visible }) {
  const { mostVisible } = await compiledModule("bop-dataset.js");
  const { bopId } = await compiledModule("bop-folder.js");
  /** @type {{ sceneId: number, imageId: number, objectId: number, count: number }[]} */
  const targets = await dataset.targets();
  const selected = [];
  for (const sceneId of numbers(targets.map((target) => target.sceneId))) {
    const of = targets.filter((target) => target.sceneId === sceneId);
    const scene = await dataset.scene(sceneId);
    for (const imageId of spread(numbers(of.map((target) => target.imageId)), images)) {
      const here = of.filter((target) => target.imageId === imageId).sort((a, b) => a.objectId - b.objectId);
      for (const target of here) {
        for (const place of mostVisible(scene, target)) {
          const fraction = scene.visible.get(bopId(imageId))?.[place] ?? 1;
          if (fraction < visible) continue;
          selected.push({ sceneId, imageId, objectId: target.objectId, place, visible: fraction });
        }
      }
    }
  }
  return selected;
}

/** Each number once, in ascending order. @param {readonly number[]} all */
const numbers = (all) => [...new Set(all)].sort((a, b) => a - b);

/**
 * At most so many of a list: the middles of as many equal parts.
 * @param {readonly number[]} all
 * @param {number} count
 */
function spread(all, count) {
  if (all.length <= count) return all;
  const places = new Set(Array.from({ length: count }, (_, i) => Math.floor(((i + 0.5) * all.length) / count)));
  return all.filter((_, i) => places.has(i));
}
