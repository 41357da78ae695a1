/** Converts colours to what the core takes: sRGB-encoded red, green and blue, a byte each. */

import type { Photo } from "../modules/core-input.js";
import { isTypedArray } from "../values/kinds.js";
import { nearest } from "../values/pixels.js";

/** Arrays of colours: whole numbers from 0 to 255, or floats from 0 to 1. */
export type ColorArray = Uint8Array | Uint8ClampedArray | Float32Array;

/** The encoding of colours: as in images, or proportional to light. */
export type ColorSpace = "srgb" | "linear";

/** Maximum number of pixels of a photo for the core; photos from files are reduced to as many. */
const MAX_PHOTO_PIXELS = 1 << 21;

/** The colours without their alpha. */
export function rgbOf(colors: ColorArray, channels: number, space: ColorSpace = "srgb"): Uint8Array {
  if (channels === 3 && space === "srgb" && isTypedArray<Uint8Array>(colors, "Uint8Array")) return colors;
  const encode = encoder(isTypedArray(colors, "Float32Array"), space);
  const count = colors.length / channels;
  const rgb = new Uint8Array(3 * count);
  for (let i = 0; i < count; i++) {
    for (let c = 0; c < 3; c++) rgb[3 * i + c] = encode(colors[channels * i + c] as number);
  }
  return rgb;
}

function encoder(isFloat: boolean, space: ColorSpace): (value: number) => number {
  if (space === "linear") return isFloat ? encoded : (value) => encoded(value / 255);
  // Rounds half up, and clamps; NaN is 0.
  return isFloat ? (value) => Math.max(0, Math.min(255, Math.floor(value * 255 + 0.5))) || 0 : (value) => value;
}

/** The linear light of an sRGB value, 0 to 1. `Math.pow` may differ by the last of 53 bits between engines. */
export const lightOf = (x: number) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);

/** The same, rounded to 32 bits, in which all engines agree. */
export const linear = (x: number) => Math.fround(lightOf(x));

/** The linear light halfway between adjacent sRGB codes. */
const bounds = Array.from({ length: 255 }, (_, code) => linear((code + 0.5) / 255));

/** The sRGB code of linear light. */
function encoded(light: number): number {
  let [low, high] = [0, bounds.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (light >= (bounds[middle] as number)) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** A photo for the core, averaged to a smaller one if it is large, as the readers of files do. */
export function photoOf(data: ColorArray, channels: number, width: number, height: number): Photo {
  return averaged(data, channels, [width, height], reducedSize(width, height));
}

/** An image without its alpha, averaged to a size that is the same or smaller. */
export function averaged(
  data: ColorArray,
  channels: number,
  [width, height]: readonly [number, number],
  [newWidth, newHeight]: readonly [number, number],
): Photo {
  if (newWidth === width && newHeight === height) return { data: rgbOf(data, channels), width, height };
  const sums = new Uint32Array(3 * newWidth * newHeight);
  const counts = new Uint32Array(newWidth * newHeight);
  // Each pixel counts where its centre lies.
  const columns = Uint32Array.from({ length: width }, (_, u) => nearest(u, width, newWidth));
  for (let v = 0; v < height; v++) {
    const row = nearest(v, height, newHeight) * newWidth;
    for (let u = 0; u < width; u++) {
      const [to, from] = [row + (columns[u] as number), channels * (v * width + u)];
      counts[to] = (counts[to] as number) + 1;
      for (let c = 0; c < 3; c++) sums[3 * to + c] = (sums[3 * to + c] as number) + (data[from + c] as number);
    }
  }
  const mean = (sum: number, i: number) => {
    const count = counts[Math.floor(i / 3)] as number;
    return Math.floor((sum + Math.floor(count / 2)) / count);
  };
  return { data: Uint8Array.from(sums, mean), width: newWidth, height: newHeight };
}

function reducedSize(width: number, height: number): [number, number] {
  for (let by = 1; ; by++) {
    const [w, h] = [width, height].map((side) => Math.max(1, Math.floor(side / by))) as [number, number];
    if (w * h <= MAX_PHOTO_PIXELS) return [w, h];
  }
}
