/** Resizes and crops images together with their intrinsics. */

import { pinholeOf, resizedPinhole } from "../camera/pinhole.js";
import type { CameraInput, PinholeCamera } from "../types/inputs.js";
import { plainArgument } from "../values/border.js";
import { describe, failure } from "../values/error.js";
import {
  type DepthPixels,
  depthKinds,
  type ImageSize,
  type MaskPixels,
  maskKinds,
  nearest,
  type PixelArray,
  pixelsOf,
  pointKinds,
  sizeOf,
} from "../values/pixels.js";
import { optionsOf, record, whole } from "../values/values.js";

/** A region of an image, in integer pixels. */
export interface PixelBox extends ImageSize {
  /** The first column. */
  left: number;
  /** The first row. */
  top: number;
}

/** Samples `source` at the position of each new pixel, for all channels. */
function sampled<T extends Float32Array | Uint16Array | MaskPixels>(
  { data, width }: PixelArray<T>,
  to: ImageSize,
  source: { column: (u: number) => number; row: (v: number) => number },
  channels = 1,
): PixelArray<T> {
  const length = to.width * to.height * channels;
  const Kind = data.constructor as new (length: number) => T;
  const result = new Kind(length);
  for (let v = 0; v < to.height; v++) {
    const row = source.row(v) * width;
    for (let u = 0; u < to.width; u++) {
      const from = (row + source.column(u)) * channels;
      for (let c = 0; c < channels; c++) result[(v * to.width + u) * channels + c] = data[from + c] ?? 0;
    }
  }
  return { data: result, width: to.width, height: to.height };
}

function resized<T extends DepthPixels | MaskPixels>(image: PixelArray<T>, to: unknown): PixelArray<T> {
  const size = sizeOf("size", to);
  const column = (u: number) => nearest(u, size.width, image.width);
  return sampled(image, size, { column, row: (v) => nearest(v, size.height, image.height) });
}

/**
 * Resizes a depth map by nearest-neighbour sampling, because interpolation would create flying pixels at every edge.
 * Resize the camera as well: {@link resizeCamera}.
 *
 * @example
 * const small = resizeDepth(depth, { width: 640, height: 480 });
 * @throws {@link Sim3AlignError} for arrays of the wrong type or length, and for sizes below one pixel
 */
export const resizeDepth = <T extends DepthPixels>(depth: PixelArray<T>, size: ImageSize): PixelArray<T> =>
  resized(pixelsOf<T>("depth", depth, depthKinds), size);

/**
 * Resizes a mask by nearest-neighbour sampling.
 *
 * @example
 * const mask = resizeMask(maskFromTensor(masks, { index: 0 }), { width: 640, height: 480 });
 * @throws {@link Sim3AlignError} for arrays of the wrong type or length, and for sizes below one pixel
 */
export const resizeMask = <T extends MaskPixels>(mask: PixelArray<T>, size: ImageSize): PixelArray<T> =>
  resized(pixelsOf<T>("mask", mask, maskKinds), size);

/**
 * The intrinsics for a resized image. Pixel centres have integer coordinates, so an image of width w spans −0.5 to w −
 * 0.5, and cx becomes (cx + 0.5)·s − 0.5, not cx·s.
 *
 * @param camera { fx, fy, cx, cy }, { K } or { fovYDeg }, for the image of `fromWidth` × `fromHeight`
 * @param size the old and the new size, in pixels
 *
 * @example
 * resizeCamera({ fx: 600, fy: 600, cx: 319.5, cy: 239.5 }, { fromWidth: 640, fromHeight: 480, width: 320, height: 240 });
 * // { fx: 300, fy: 300, cx: 159.5, cy: 119.5, width: 320, height: 240 }
 * @throws {@link Sim3AlignError} `INVALID_CAMERA`, or for sizes below one pixel
 */
export function resizeCamera(
  camera: CameraInput,
  size: ImageSize & { fromWidth: number; fromHeight: number },
): PinholeCamera & ImageSize {
  const sizes = record("size", size, "{ fromWidth, fromHeight, width, height }");
  const { width, height } = sizeOf("size", sizes);
  const from = {
    width: whole("size.fromWidth", sizes.fromWidth, 1),
    height: whole("size.fromHeight", sizes.fromHeight, 1),
  };
  const pinhole = pinholeOf("camera", plainArgument("camera", camera), from);
  return { ...resizedPinhole(pinhole, from, { width, height }), width, height };
}

/**
 * The bounding box of the object in a mask.
 *
 * @param mask non-zero is the object
 * @param options `marginPx`: pixels to add on every side, clipped to the image; 0 by default
 *
 * @example
 * const box = maskBox(mask, { marginPx: 40 });
 * @throws {@link Sim3AlignError} `EMPTY_MASK` if no pixel is the object
 */
export function maskBox(mask: PixelArray<MaskPixels>, options: { marginPx?: number } = {}): PixelBox {
  const { marginPx = 0 } = optionsOf(options, ["marginPx"]);
  const { data, width, height } = pixelsOf<MaskPixels>("mask", mask, maskKinds);
  const margin = whole("options.marginPx", marginPx, 0);
  let [left, top, right, bottom] = [width, height, -1, -1];
  data.forEach((pixel, i) => {
    if (pixel === 0) return;
    const [u, v] = [i % width, Math.floor(i / width)];
    [left, top] = [Math.min(left, u), Math.min(top, v)];
    [right, bottom] = [Math.max(right, u), Math.max(bottom, v)];
  });
  if (right < 0) {
    throw failure("EMPTY_MASK", "mask", "no non-zero pixel", "non-zero pixels", "Pass the mask of the object.");
  }
  [left, top] = [Math.max(0, left - margin), Math.max(0, top - margin)];
  [right, bottom] = [Math.min(width - 1, right + margin), Math.min(height - 1, bottom + margin)];
  return { left, top, width: right - left + 1, height: bottom - top + 1 };
}

/** Images and the camera that belong to them; all are optional. */
export interface CropInput {
  depth?: PixelArray<DepthPixels> | undefined;
  pointMap?: PixelArray<Float32Array> | undefined;
  mask?: PixelArray<MaskPixels> | undefined;
  /** RGB or RGBA. */
  image?: PixelArray<MaskPixels> | undefined;
  camera?: CameraInput | undefined;
}

/**
 * Crops an input, with its intrinsics: cx and cy are shifted by the corner of the box. Other properties are unchanged.
 * The camera frame is the same, so a result for the crop is also valid for the whole image.
 *
 * Leave a margin around the object: if a mask touches the image border, the object is assumed to continue beyond it.
 *
 * @param input `depth`, `mask`, `pointMap` and `image` as `{ data, width, height }`, all of one size; `camera` with
 * intrinsics
 * @param box in pixels of the image; see {@link maskBox}
 *
 * @example
 * await aligner.align(cropInput({ depth, mask, camera, mesh }, maskBox(mask, { marginPx: 40 })));
 * @throws {@link Sim3AlignError} `SIZE_MISMATCH` for images of different sizes, or a box that exceeds them
 */
export function cropInput<T extends CropInput>(input: T, box: PixelBox): T {
  const given = record("input", input, "{ depth, mask, camera }");
  const { depth, mask, pointMap, image, camera } = given as CropInput;
  const region = record("box", box, "{ left, top, width, height }");
  const { width, height } = sizeOf("box", region);
  const [left, top] = [whole("box.left", region.left, 0), whole("box.top", region.top, 0)];
  const images = Object.entries({ depth, mask, pointMap, image }).filter(([, part]) => part !== undefined);
  const [first] = images;
  if (first === undefined) {
    throw failure("INVALID_ARGUMENT", "input", describe(input), "depth, mask or pointMap", "Pass the images.");
  }
  const size = sizeOf(`input.${first[0]}`, first[1]);
  for (const [name, part] of images) {
    const found = sizeOf(`input.${name}`, part);
    if (found.width === size.width && found.height === size.height) continue;
    const expected = `${size.width} × ${size.height}, the size of ${first[0]}`;
    const remedy = "Resize the images to the same size first: resizeMask, resizeDepth.";
    throw failure("SIZE_MISMATCH", `input.${name}`, `${found.width} × ${found.height} pixels`, expected, remedy);
  }
  if (left + width > size.width || top + height > size.height) {
    const found = `${width} × ${height} pixels at ${left}, ${top}`;
    const expected = `a box within ${size.width} × ${size.height} pixels`;
    throw failure("SIZE_MISMATCH", "box", found, expected, "Keep the box within the image.");
  }
  const source = { column: (u: number) => left + u, row: (v: number) => top + v };
  const hasAlpha = image?.data?.length === 4 * size.width * size.height;
  const formats: Record<string, readonly [kinds: readonly string[], channels: number]> = {
    ...{ depth: [depthKinds, 1], mask: [maskKinds, 1], pointMap: [pointKinds, 3] },
    image: [maskKinds, hasAlpha ? 4 : 3],
  };
  const cropped = { ...given };
  for (const [name, part] of images) {
    const [kinds, channels] = formats[name] as (typeof formats)[string];
    const pixels = pixelsOf<DepthPixels | MaskPixels>(`input.${name}`, part, kinds, channels);
    cropped[name] = sampled(pixels, { width, height }, source, channels);
  }
  if (camera !== undefined) {
    const { fx, fy, cx, cy } = pinholeOf("input.camera", camera, size);
    cropped.camera = { fx, fy, cx: cx - left, cy: cy - top, width, height };
  }
  return cropped as unknown as T;
}
