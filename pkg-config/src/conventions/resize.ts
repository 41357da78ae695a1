/** Resizes and crops images together with their intrinsics. */

import { type Pinhole, pinholeOf, resizedPinhole } from "../camera/pinhole.js";
import type { CameraInput } from "../types/inputs.js";
import { failure, invalidArgument } from "../values/error.js";
import { isRecord } from "../values/kinds.js";
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
import { record, whole } from "../values/validation.js";

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

function resized<T extends DepthPixels | MaskPixels>(image: PixelArray<T>, to: unknown, channels = 1): PixelArray<T> {
  const size = sizeOf("size", to);
  const column = (u: number) => nearest(u, size.width, image.width);
  return sampled(image, size, { column, row: (v) => nearest(v, size.height, image.height) }, channels);
}

/** A mask at another size, by nearest-neighbour sampling. */
export const resizedMask = <T extends MaskPixels>(mask: PixelArray<T>, size: ImageSize): PixelArray<T> =>
  resized(pixelsOf<T>("mask", mask, maskKinds), size);

/** Images and the camera that belong to them; all are optional. */
export interface ImagesAndCamera {
  depth?: PixelArray<DepthPixels> | undefined;
  pointMap?: PixelArray<Float32Array> | undefined;
  mask?: PixelArray<MaskPixels> | undefined;
  /** RGB or RGBA. */
  image?: PixelArray<MaskPixels> | undefined;
  camera?: CameraInput | undefined;
}

/** Types and channels of the images of an input. */
const formatsOf = (
  image: PixelArray<MaskPixels> | undefined,
): Record<string, readonly [readonly string[], number]> => ({
  depth: [depthKinds, 1],
  pointMap: [pointKinds, 3],
  mask: [maskKinds, 1],
  image: [maskKinds, image !== undefined && image.data?.length === 4 * image.width * image.height ? 4 : 3],
});

/** The images of an input by their names, and the input itself. */
function imagesIn(input: unknown) {
  const given = record("input", input, "{ depth, mask, camera }");
  const { depth, pointMap, mask, image, camera } = given as ImagesAndCamera;
  if (given.cameraFile !== undefined) {
    const remedy = "Pass camera: await readCamera(cameraFile) of sim3align/formats, which is changed with the images.";
    throw invalidArgument("cameraFile", given.cameraFile, "camera", remedy);
  }
  const images = Object.entries({ depth, pointMap, mask, image }).filter(([, part]) => part !== undefined);
  return { given, images, camera, formats: formatsOf(image) };
}

/**
 * Resizes an input, with its intrinsics. Depth, point maps and masks are sampled at the nearest pixel, because interpolated
 * depth has false points at every edge; they may differ in size. The photo is unchanged, because `align` takes one of any
 * size, as are all other properties.
 *
 * Pixel centres have integer coordinates, so an image of width w spans −0.5 to w − 0.5, and cx becomes (cx + 0.5)·s − 0.5,
 * not cx·s.
 *
 * @param input `depth`, `pointMap` and `mask` as `{ data, width, height }`; `camera` with intrinsics for its `width` and
 * `height` or, without these, for the first of the images
 * @param size the new size, in pixels
 *
 * @example
 * const { mask } = resizeInput({ mask: fromTensor(masks, "mask") }, { width: 640, height: 480 });
 * resizeInput({ camera: { fx: 600, fy: 600, cx: 319.5, cy: 239.5, width: 640, height: 480 } }, { width: 320, height: 240 });
 * // { camera: { fx: 300, fy: 300, cx: 159.5, cy: 119.5, width: 320, height: 240 } }
 * @throws {@link Sim3AlignError} for arrays of the wrong type or length, for sizes below one pixel, and `INVALID_CAMERA`
 */
export function resizeInput<T extends ImagesAndCamera>(input: T, size: ImageSize): T {
  const { given, images, camera, formats } = imagesIn(input);
  const to = sizeOf("size", size);
  const changed = { ...given };
  for (const [name, part] of images) {
    if (name === "image") continue;
    const [kinds, channels] = formats[name] as readonly [readonly string[], number];
    changed[name] = resized(pixelsOf<DepthPixels | MaskPixels>(`input.${name}`, part, kinds, channels), to, channels);
  }
  if (camera !== undefined) changed.camera = resizedCamera(camera, images[0], to);
  return changed as unknown as T;
}

/**
 * A camera for another size of its image, with all else that it states, such as the unit of depth.
 * @param first the image that the intrinsics belong to if the camera states no size, and its name
 */
function resizedCamera(camera: CameraInput, first: readonly [string, unknown] | undefined, to: ImageSize): Pinhole {
  const { K: _, fovYDeg: __, ...others } = (isRecord(camera) ? camera : {}) as Record<string, unknown>;
  const isSized = others.width !== undefined || first === undefined;
  const from = isSized ? sizeOf("input.camera", camera) : sizeOf(`input.${first[0]}`, first[1]);
  const resized = resizedPinhole(pinholeOf("input.camera", camera, from), from, to);
  const sampled = first === undefined ? from : sizeOf(`input.${first[0]}`, first[1]);
  const { cx, cy } = resized;
  const ofSamples = {
    ...resized,
    cx: cx - offset(sampled.width / to.width),
    cy: cy - offset(sampled.height / to.height),
  };
  return { ...others, ...ofSamples, ...to };
}

/** How far the samples of a reduction are beside the middles of the new pixels: of an even number, none is in the middle. */
const offset = (factor: number) => (factor % 2 === 0 ? 0.5 / factor : 0);

/** The bounding box of the object in a mask, with a margin that is clipped to the image. */
function maskBox(mask: unknown, marginPx: unknown): PixelBox {
  const { data, width, height } = pixelsOf<MaskPixels>("input.mask", mask, maskKinds);
  const margin = whole("box.marginPx", marginPx, 0);
  let [left, top, right, bottom] = [width, height, -1, -1];
  data.forEach((pixel, i) => {
    if (pixel === 0) return;
    const [u, v] = [i % width, Math.floor(i / width)];
    [left, top] = [Math.min(left, u), Math.min(top, v)];
    [right, bottom] = [Math.max(right, u), Math.max(bottom, v)];
  });
  if (right < 0) {
    throw failure("EMPTY_MASK", "input.mask", "no non-zero pixel", "non-zero pixels", "Pass the mask of the object.");
  }
  [left, top] = [Math.max(0, left - margin), Math.max(0, top - margin)];
  [right, bottom] = [Math.min(width - 1, right + margin), Math.min(height - 1, bottom + margin)];
  return { left, top, width: right - left + 1, height: bottom - top + 1 };
}

/**
 * Crops an input, with its intrinsics: cx and cy are shifted by the corner of the box. Other properties are unchanged.
 * The camera frame is the same, so a result for the crop is also valid for the whole image.
 *
 * Leave a margin around the object: if a mask touches the image border, the object is assumed to continue beyond it.
 *
 * @param input `depth`, `mask`, `pointMap` and `image` as `{ data, width, height }`, all of one size; `camera` with
 * intrinsics for its `width` and `height` or, without these, for that size
 * @param box in pixels of the image; or `{ marginPx }`, for the box around the object in the mask, with a margin of so many
 * pixels that is clipped to the image
 *
 * @example
 * await aligner.align(cropInput({ depth, mask, camera, mesh }, { marginPx: 40 }));
 * @throws {@link Sim3AlignError} `SIZE_MISMATCH` for images of different sizes, or a box that exceeds them; `EMPTY_MASK`
 */
export function cropInput<T extends ImagesAndCamera>(input: T, box: PixelBox | { marginPx: number }): T {
  const { given, images, camera, formats } = imagesIn(input);
  const named = record("box", box, "{ left, top, width, height }, or { marginPx }");
  const region = named.marginPx === undefined ? named : { ...maskBox(given.mask, named.marginPx) };
  const { width, height } = sizeOf("box", region);
  const [left, top] = [whole("box.left", region.left, 0), whole("box.top", region.top, 0)];
  const [first] = images;
  if (first === undefined) {
    throw invalidArgument("input", input, "depth, mask or pointMap", "Pass the images.");
  }
  const size = sizeOf(`input.${first[0]}`, first[1]);
  for (const [name, part] of images) {
    const found = sizeOf(`input.${name}`, part);
    if (found.width === size.width && found.height === size.height) continue;
    const expected = `${size.width} × ${size.height}, the size of ${first[0]}`;
    const remedy = "Resize the images to the same size first: resizeInput.";
    throw failure("SIZE_MISMATCH", `input.${name}`, `${found.width} × ${found.height} pixels`, expected, remedy);
  }
  if (left + width > size.width || top + height > size.height) {
    const found = `${width} × ${height} pixels at ${left}, ${top}`;
    const expected = `a box within ${size.width} × ${size.height} pixels`;
    throw failure("SIZE_MISMATCH", "box", found, expected, "Keep the box within the image.");
  }
  const source = { column: (u: number) => left + u, row: (v: number) => top + v };
  const cropped = { ...given };
  for (const [name, part] of images) {
    const [kinds, channels] = formats[name] as readonly [readonly string[], number];
    const pixels = pixelsOf<DepthPixels | MaskPixels>(`input.${name}`, part, kinds, channels);
    cropped[name] = sampled(pixels, { width, height }, source, channels);
  }
  if (camera !== undefined) {
    const whole = resizedCamera(camera, first, size);
    cropped.camera = { ...whole, cx: whole.cx - left, cy: whole.cy - top, width, height };
  }
  return cropped as unknown as T;
}
