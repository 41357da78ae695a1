/** The part of the image that the objects are in. */
import { maskBox } from "sim3align/conventions";
import type { Scene } from "../state/scene.js";

/** How much of the view the objects take, at most. */
const SHARE = 0.62;
/** Beyond this, pixels are all that is seen. */
const MAX_FACTOR = 8;

/** A factor, and the place that comes to the middle, as shares of the image. */
export interface Zoom {
  factor: number;
  x: number;
  y: number;
}

export const wholeImage: Zoom = { factor: 1, x: 0.5, y: 0.5 };

/** What brings all objects of the scene into view. */
export function zoomToObjects({ objects, width, height }: Scene): Zoom {
  const union = new Uint8Array(width * height);
  for (const { mask } of objects) {
    mask.forEach((inside, pixel) => {
      if (inside !== 0) union[pixel] = 1;
    });
  }
  if (!union.includes(1)) return wholeImage;
  const box = maskBox({ data: union, width, height });
  const factor = SHARE * Math.min(width / box.width, height / box.height);
  if (factor <= 1) return wholeImage;
  const bounded = Math.min(factor, MAX_FACTOR);
  // The image's own border is where it ends.
  const half = 0.5 / bounded;
  const inside = (middle: number) => Math.min(Math.max(middle, half), 1 - half);
  return {
    factor: bounded,
    x: inside((box.left + box.width / 2) / width),
    y: inside((box.top + box.height / 2) / height),
  };
}
