/** Scenes for drawing: those with more pixels than screens show are reduced, so that no frame has to wait for them. */

import { once } from "../state/inputs.js";
import type { ObjectModel } from "../state/object-model.js";
import type { Scene } from "../state/scene.js";
import { type Box, boxOf } from "./box.js";

/** Full HD is drawn as it is. */
const MOST_PIXELS = 2_100_000;

/** A scene at the size that is drawn. Pixel (x, y) of it is pixel (x · step + offset, y · step + offset) of the scene. */
export interface DrawnScene extends Omit<Scene, "objects"> {
  readonly step: number;
  readonly offset: number;
  /** The mask of an object, at this size. */
  maskOf(object: ObjectModel): Uint8Array;
  /** The box around that mask; null if it is empty. */
  maskBoxOf(object: ObjectModel): Box | null;
}

/** The scene at the size that is drawn. */
export const drawnScene = once((scene: Scene): DrawnScene => {
  const step = Math.ceil(Math.sqrt((scene.width * scene.height) / MOST_PIXELS));
  if (step === 1) return { ...scene, step, offset: 0, ...masksOf((mask) => mask, scene.width) };
  const offset = Math.floor(step / 2);
  const [width, height] = [Math.floor(scene.width / step), Math.floor(scene.height / step)];
  /** The pixels that are drawn. */
  const picked = <T extends Float32Array | Uint8Array | Uint32Array>(from: T, into: T): T => {
    for (let y = 0; y < height; y++) {
      const row = (y * step + offset) * scene.width + offset;
      for (let x = 0; x < width; x++) into[y * width + x] = from[row + x * step] as number;
    }
    return into;
  };
  const { fx, fy, cx, cy } = scene.camera;
  const reduced = once((mask: Uint8Array) => picked(mask, new Uint8Array(width * height)));
  const { rgba } = scene;
  const coloured = new Uint8ClampedArray(rgba === null ? 0 : 4 * width * height);
  if (rgba !== null) picked(new Uint32Array(rgba.buffer, rgba.byteOffset), new Uint32Array(coloured.buffer));
  return {
    ...scene,
    ...{ width, height, step, offset, ...masksOf(reduced, width) },
    depthM: picked(scene.depthM, new Float32Array(width * height)),
    rgba: rgba === null ? null : coloured,
    camera: { fx: fx / step, fy: fy / step, cx: (cx - offset) / step, cy: (cy - offset) / step },
  };
});

/** Masks with their boxes: a pose changes with every frame of a drag, the box of a mask does not. */
function masksOf(reduced: (mask: Uint8Array) => Uint8Array, width: number): Pick<DrawnScene, "maskOf" | "maskBoxOf"> {
  const boxOfMask = once((mask: Uint8Array) => boxOf(reduced(mask), width));
  return { maskOf: ({ mask }) => reduced(mask), maskBoxOf: ({ mask }) => boxOfMask(mask) };
}
