/** The pixels of three.js textures. */
import { isBytes } from "../input/bytes.js";
import { averaged, linear } from "../input/colors.js";
import type { Photo } from "../modules/core-input.js";
import { type Fields, isObject } from "./types.js";

/** A texture: its colours by texture coordinates. */
export interface Texels {
  /** Writes the linear red, green and blue at texture coordinates to `out`. */
  colorAt(u: number, v: number, out: Float64Array): void;
}

/** Maximum width and height; larger images are averaged: surfaces are sampled more coarsely anyway. */
const MAX_SIDE = 512;

/** The constants of three.js for textures that repeat. Others continue the colours of their edges. */
const repeatWrapping = 1000;
const mirroredRepeatWrapping = 1002;

/** The light of each code, taken as proportional to light, and as sRGB. */
const codes = Float32Array.from({ length: 256 }, (_, code) => code / 255);
const decoded = codes.map(linear);

/**
 * The texels of a `Texture`; null if its image cannot be read: not loaded, compressed, of another origin, or an element
 * or bitmap where the runtime has no `OffscreenCanvas`.
 */
export function texelsOf(map: Fields): Texels | null {
  const { image, flipY, colorSpace, wrapS, wrapT } = map;
  const pixels = isObject(image) ? (pixelsOf(image) ?? drawn(image)) : null;
  if (pixels === null) return null;
  const { data, width, height } = pixels;
  if (map.matrixAutoUpdate === true && typeof map.updateMatrix === "function") map.updateMatrix();
  const { elements = [1, 0, 0, 0, 1, 0, 0, 0, 1] } = (isObject(map.matrix) ? map.matrix : {}) as {
    elements?: number[];
  };
  const [a = 1, b = 0, , c = 0, d = 1, , e = 0, f = 0] = elements;
  const light = colorSpace === "srgb" ? decoded : codes;
  // Graphics cards ignore the flag for bitmaps.
  const isFlipped = flipY === true && !(globalThis.ImageBitmap && image instanceof globalThis.ImageBitmap);
  return {
    colorAt(u, v, out) {
      const [x, y] = [a * u + c * v + e, b * u + d * v + f];
      const column = wrapped(x, wrapS, width);
      const row = wrapped(isFlipped ? 1 - y : y, wrapT, height);
      const at = 3 * (row * width + column);
      for (let channel = 0; channel < 3; channel++) out[channel] = light[data[at + channel] ?? 0] ?? 0;
    },
  };
}

/** The column or row of a texture coordinate. */
function wrapped(x: number, wrapping: unknown, size: number): number {
  const floor = Math.floor(x);
  let within = x;
  if (wrapping === repeatWrapping) within = x - floor;
  else if (wrapping === mirroredRepeatWrapping) within = floor % 2 === 0 ? x - floor : 1 - (x - floor);
  return Math.max(0, Math.min(size - 1, Math.floor(within * size))) || 0;
}

/** The pixels of a `DataTexture`, an `ImageData` or the like. */
function pixelsOf({ data, width, height }: Fields): Photo | null {
  if (!isBytes(data)) return null;
  if (!isSide(width) || !isSide(height) || data.length !== 4 * width * height) return null;
  return averaged(data, 4, [width, height], [Math.min(width, MAX_SIDE), Math.min(height, MAX_SIDE)]);
}

const isSide = (side: unknown): side is number => Number.isSafeInteger(side) && (side as number) > 0;

/** The pixels of an element or a bitmap, by way of a canvas; null where that fails. */
function drawn(image: Fields): Photo | null {
  const sides = [image.naturalWidth ?? image.width, image.naturalHeight ?? image.height];
  const [width, height] = sides.map((side) => (isSide(side) ? Math.min(side, MAX_SIDE) : 0)) as [number, number];
  if (width === 0 || height === 0 || typeof OffscreenCanvas === "undefined") return null;
  try {
    const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
    if (!context) return null;
    context.imageSmoothingQuality = "high";
    context.drawImage(image as never, 0, 0, width, height);
    return pixelsOf({ data: context.getImageData(0, 0, width, height).data, width, height });
  } catch {
    // No image, or one of another origin, whose pixels scripts must not see.
    return null;
  }
}
