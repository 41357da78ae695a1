/** How much of an object is hidden, and by what. */
import type { ObjectModel } from "../state/object-model.js";
import type { Scene } from "../state/scene.js";
import { renderDepth } from "./rasteriser.js";
import { drawnScene } from "./reduced.js";

/** The scene is in front if it is this much nearer, as a share of the depth. */
const NEARER = 0.02;
/** Depth cameras blur edges: a pixel is compared with those at this distance. */
const ACROSS_EDGE = 3;

/** What hides an object. */
export interface Occlusion {
  /** The share of the drawn mesh behind other parts of the scene, 0 to 1. */
  hidden: number;
  /** The overlap (IoU) of the mask with the rest of the drawn mesh. */
  visibleIou: number;
  /**
   * Whether what hides it stands in front of the visible part as well. Of a mesh that is sunk into a surface, or behind it, the
   * surface is hidden by nothing: it goes on from the mask without a step.
   */
  isBehindSomething: boolean;
}

export function occlusionOf(scene: Scene, object: ObjectModel): Occlusion {
  const { depthM, maskOf, width, ...view } = drawnScene(scene);
  const mask = maskOf(object);
  const drawn = renderDepth(object.mesh, object.pose.value.transform.matrix, { ...view, width });
  const neighbours = [-1, 1, -width, width].map((step) => step * ACROSS_EDGE);
  let [all, hidden, both, either, edges, steps] = [0, 0, 0, 0, 0, 0];
  drawn.forEach((z, pixel) => {
    const measured = depthM[pixel] ?? 0;
    const isObject = mask[pixel] !== 0;
    if (z > 0) all++;
    if (z > 0 && !isObject && measured > 0 && measured < (1 - NEARER) * z) {
      hidden++;
      for (const step of neighbours) {
        const beside = depthM[pixel + step] ?? 0;
        if (!mask[pixel + step] || !(beside > 0)) continue;
        edges++;
        if (measured < (1 - NEARER) * beside) steps++;
      }
      return;
    }
    if (z > 0 && isObject) both++;
    if (z > 0 || isObject) either++;
  });
  return { hidden: hidden / (all || 1), visibleIou: both / (either || 1), isBehindSomething: 2 * steps > edges };
}
