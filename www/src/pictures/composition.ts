/** Composes the image of the image view. */
import { differenceColour, differenceLimit, type Rgb } from "sim3align/pictures/colours";
import { outlineOf } from "sim3align/pictures/shading";
import type { ImageLayers } from "../state/display.js";
import type { ObjectModel } from "../state/object-model.js";
import { type Box, boxAround, boxOf } from "./box.js";
import { rgbOf } from "./colours.js";
import { renderDepth } from "./rasteriser.js";
import type { DrawnScene } from "./reduced.js";
import type { Zoom } from "./zoom.js";

/** An object, rendered at a pose. */
export interface DrawnObject {
  mask: Uint8Array;
  colour: string;
  /** Metres; 0 outside the silhouette. */
  depth: Float32Array;
  isSelected: boolean;
  /** Around mask and silhouette; null if both are empty. */
  box: Box | null;
  /** The depth difference that saturates the colour, metres. */
  limitM: number;
}

/** Renders an object at a pose; without one, its mask alone. */
export function drawObject(scene: DrawnScene, object: ObjectModel, matrix: ArrayLike<number> | null): DrawnObject {
  const { mesh, colour } = object;
  const mask = scene.maskOf(object);
  const depth = matrix === null ? new Float32Array(mask.length) : renderDepth(mesh, matrix, scene);
  const box = boxAround(scene.maskBoxOf(object), boxOf(depth, scene.width));
  return { mask, colour, isSelected: false, depth, box, limitM: differenceLimit(object.visible.peek().sizeM) };
}

/** Draws `before` left of the wipe and `after` right of it. */
export function compose(
  scene: DrawnScene,
  base: Uint8ClampedArray,
  before: readonly DrawnObject[],
  after: readonly DrawnObject[],
  { base: shown, outline, silhouette, difference, wipe }: ImageLayers,
  zoom: Zoom,
): ImageData {
  const { width, height, depthM } = scene;
  const image = new ImageData(Uint8ClampedArray.from(base), width, height);
  const split = wipe >= 1 ? width : wipe > 0 ? columnAt(wipe, zoom, width) : 0;
  const thickness = Math.max(1, Math.round(width / 400));
  paint(before, 0, split);
  paint(after, split, width);
  if (split > 0 && split < width) {
    // The line has the same width on the screen at every zoom.
    const line = Math.max(1, Math.round(width / zoom.factor / 200));
    for (let v = 0; v < height; v++) {
      for (let u = split; u < Math.min(split + line, width); u++) mix(image.data, v * width + u, [255, 255, 255], 1);
    }
  }
  return image;

  function paint(objects: readonly DrawnObject[], left: number, right: number): void {
    for (const object of objects) {
      const { mask, colour, depth, box, isSelected, limitM } = object;
      if (box === null) continue;
      const others = objects.filter((one) => one !== object);
      const own = rgbOf(colour);
      const isEdge = outlineOf({ data: depth, width, height }, thickness);
      const isBorder = outlineOf({ data: mask, width, height }, thickness);
      // Over a photo, a little is enough, and the object's own colours stay.
      const fill = (isSelected ? 0.45 : 0.3) * (shown === "photo" ? 0.45 : 1);
      for (let v = box.top; v < box.bottom; v++) {
        for (let u = Math.max(left, box.left); u < Math.min(right, box.right); u++) {
          const pixel = v * width + u;
          const [mesh, measured] = [depth[pixel] as number, depthM[pixel] as number];
          // Something nearer, in the scene or among the objects, hides the mesh: its outline shows through, faintly.
          const isHidden =
            mesh > 0 &&
            ((mask[pixel] === 0 && measured > 0 && measured < mesh - limitM) ||
              others.some((one) => (one.depth[pixel] as number) > 0 && (one.depth[pixel] as number) < mesh));
          if (mesh > 0 && difference && mask[pixel] !== 0 && measured > 0) {
            mix(image.data, pixel, differenceColour(mesh - measured, limitM), 0.92);
          } else if (mesh > 0 && silhouette && !isHidden) mix(image.data, pixel, own, fill);
          if ((silhouette || difference) && isEdge(pixel)) mix(image.data, pixel, own, isHidden ? 0.4 : 1);
          if (outline && isBorder(pixel)) mix(image.data, pixel, [255, 255, 255], 0.95);
        }
      }
    }
  }
}

/** The column at a share of the visible width. */
function columnAt(share: number, { factor, x }: Zoom, width: number): number {
  const column = Math.round((x + (share - 0.5) / factor) * width);
  return Math.min(Math.max(column, 0), width);
}

function mix(data: Uint8ClampedArray, pixel: number, colour: Rgb, share: number): void {
  for (let k = 0; k < 3; k++) {
    const place = 4 * pixel + k;
    data[place] = (data[place] as number) * (1 - share) + (colour[k] as number) * share;
  }
}
