/** The pixels of three.js textures. */
import { isTypedArray } from "../values.js";

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

/** Light of each code, taken as proportional to light, and as sRGB. `Math.pow` may differ by its last bit between engines. */
const codes = Float32Array.from({ length: 256 }, (_, code) => code / 255);
const decoded = codes.map((x) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4));

/** RGBA, 0 to 255, first row first. */
interface Pixels {
  data: ArrayLike<number>;
  width: number;
  height: number;
}

type Fields = Record<string, unknown>;
const isObject = (value: unknown): value is Fields => typeof value === "object" && value !== null;

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
      const at = 4 * (row * width + column);
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
function pixelsOf({ data, width, height }: Fields): Pixels | null {
  if (!isTypedArray<Uint8Array>(data, "Uint8Array", "Uint8ClampedArray")) return null;
  if (!isSide(width) || !isSide(height) || data.length !== 4 * width * height) return null;
  return reduced({ data, width, height });
}

const isSide = (side: unknown): side is number => Number.isSafeInteger(side) && (side as number) > 0;

/** An image of more than {@link MAX_SIDE} pixels a side, averaged. */
function reduced(image: Pixels): Pixels {
  const [width, height] = [Math.min(image.width, MAX_SIDE), Math.min(image.height, MAX_SIDE)];
  if (width === image.width && height === image.height) return image;
  const sums = new Float64Array(4 * width * height);
  const counts = new Uint32Array(width * height);
  for (let v = 0; v < image.height; v++) {
    const row = Math.floor(((v + 0.5) * height) / image.height);
    for (let u = 0; u < image.width; u++) {
      const place = row * width + Math.floor(((u + 0.5) * width) / image.width);
      counts[place] = (counts[place] as number) + 1;
      for (let c = 0; c < 4; c++) {
        sums[4 * place + c] = (sums[4 * place + c] as number) + (image.data[4 * (v * image.width + u) + c] as number);
      }
    }
  }
  return { data: sums.map((sum, i) => Math.round(sum / (counts[i >> 2] as number))), width, height };
}

/** The pixels of an element or a bitmap, by way of a canvas; null where that fails. */
function drawn(image: Fields): Pixels | null {
  const sides = [image.naturalWidth ?? image.width, image.naturalHeight ?? image.height];
  const [width, height] = sides.map((side) => (isSide(side) ? Math.min(side, MAX_SIDE) : 0)) as [number, number];
  if (width === 0 || height === 0 || typeof OffscreenCanvas === "undefined") return null;
  try {
    const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
    if (!context) return null;
    context.imageSmoothingQuality = "high";
    context.drawImage(image as never, 0, 0, width, height);
    return context.getImageData(0, 0, width, height);
  } catch {
    // No image, or one of another origin, whose pixels scripts must not see.
    return null;
  }
}
