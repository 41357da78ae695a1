/** The part of the image that shows the objects. */
import { boxOf } from "../pictures/box.js";
import type { Model } from "./model.js";
import type { ObjectInput, SceneInput } from "./types.js";
import type { Rect } from "./viewpoint.js";

/** The smallest rectangle that shows all masks and all meshes; `null` if there are none. */
export function cropOf(
  { width, camera }: SceneInput,
  objects: readonly ObjectInput[],
  models: ReadonlyMap<string, Model>,
): Rect | null {
  const rect = { left: Number.POSITIVE_INFINITY, top: Number.POSITIVE_INFINITY, right: -1, bottom: -1 };
  const add = (u: number, v: number) => {
    [rect.left, rect.right] = [Math.min(rect.left, u), Math.max(rect.right, u)];
    [rect.top, rect.bottom] = [Math.min(rect.top, v), Math.max(rect.bottom, v)];
  };
  for (const { id, mask } of objects) {
    const box = boxOf(mask, width);
    if (box !== null) {
      add(box.left, box.top);
      add(box.right - 1, box.bottom - 1);
    }
    for (const { x, y, z } of models.get(id)?.corners() ?? []) {
      if (z > 0) add((camera.fx * x) / z + camera.cx, (camera.fy * y) / z + camera.cy);
    }
  }
  return rect.right < 0 ? null : rect;
}
