/** Images: pixels and their size. */

import { checkAttached } from "./border.js";
import { failure } from "./error.js";
import { isTypedArray } from "./kinds.js";
import { record, whole, wrongKind } from "./validation.js";

/** Pixels and their size: `data` has width × height values, row-major from the top left. */
export interface PixelArray<T> {
  data: T;
  /** Width in pixels. */
  width: number;
  /** Height in pixels. */
  height: number;
}

/** The size of an image in pixels. */
export interface ImageSize {
  /** Width in pixels. */
  width: number;
  /** Height in pixels. */
  height: number;
}

/** The pixels of a mask; non-zero is the object. */
export type MaskPixels = Uint8Array | Uint8ClampedArray;

/** The pixels of a depth map. */
export type DepthPixels = Float32Array | Uint16Array;

/** Maximum number of pixels of an image, as for image files: 8192 × 8192. */
export const MAX_PIXELS = 1 << 26;

/** The index of the old pixel that contains the centre of a new one, along a side that is resized. */
export const nearest = (i: number, to: number, from: number) => Math.floor(((2 * i + 1) * from) / (2 * to));

/** Validates an image size of at least one pixel, before memory is allocated for it. */
export function sizeOf(argument: string, size: unknown): ImageSize {
  const given = record(argument, size, "{ width, height }");
  const [width, height] = [whole(`${argument}.width`, given.width, 1), whole(`${argument}.height`, given.height, 1)];
  if (width * height <= MAX_PIXELS) return { width, height };
  const expected = `at most ${MAX_PIXELS} pixels (8192 × 8192)`;
  const remedy = "Check the order of the numbers.";
  throw failure("INVALID_ARGUMENT", argument, `${width} × ${height} pixels`, expected, remedy);
}

/** Validates an image: its array type, and the number of its values. */
export function pixelsOf<T extends ArrayLike<number>>(
  argument: string,
  image: unknown,
  kinds: readonly string[],
  channels = 1,
): PixelArray<T> {
  const given = record(argument, image, "{ data, width, height }");
  const { data } = given;
  const { width, height } = sizeOf(argument, given);
  if (!isTypedArray<T>(data, ...kinds)) throw wrongKind(`${argument}.data`, data, kinds.join(" or "), kinds[0] ?? "");
  checkAttached(`${argument}.data`, data);
  checkCount(`${argument}.data`, data.length, { width, height }, channels);
  return { data, width, height };
}

/** Checks that the number of values matches the size. */
export function checkCount(argument: string, count: number, { width, height }: ImageSize, channels = 1): void {
  if (count === width * height * channels) return;
  const perPixel = channels === 1 ? "" : ` × ${channels}`;
  const expected = `${width} × ${height}${perPixel} = ${width * height * channels}`;
  const remedy = "Pass the size of the image that the values belong to.";
  throw failure("WRONG_LENGTH", argument, `${count} values`, expected, remedy);
}

/** The array types of masks and depth maps. */
export const maskKinds = ["Uint8Array", "Uint8ClampedArray"];
export const depthKinds = ["Float32Array", "Uint16Array"];
export const pointKinds = ["Float32Array"];
