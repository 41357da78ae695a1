/** How much of an object is hidden. */
import type { ObjectModel } from "../state/object-model.js";
import type { Scene } from "../state/scene.js";
import { renderDepth } from "./rasteriser.js";
import { drawnScene } from "./reduced.js";

/** The scene is in front of the mesh if it is this much nearer, as a share of the depth. */
const NEARER = 0.02;

/** The share of the drawn mesh behind other parts of the scene, 0 to 1. */
export function hiddenShare(scene: Scene, object: ObjectModel): number {
  const { depthM, maskOf, ...view } = drawnScene(scene);
  const mask = maskOf(object);
  const drawn = renderDepth(object.mesh, object.pose.value.transform.matrix, view);
  let [all, hidden] = [0, 0];
  drawn.forEach((z, pixel) => {
    if (z === 0) return;
    all++;
    const measured = depthM[pixel] ?? 0;
    if (mask[pixel] === 0 && measured > 0 && measured < (1 - NEARER) * z) hidden++;
  });
  return all === 0 ? 0 : hidden / all;
}
