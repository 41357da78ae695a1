/** The output of MoGe: a point map, a mask of valid points, and normalised intrinsics. */

import { pinholeOf } from "../camera/pinhole.js";
import type { PinholeCamera } from "../types/inputs.js";
import { isTypedArray } from "../values/kinds.js";
import { checkCount, type ImageSize, type PixelArray, pixelsOf, pointKinds, sizeOf } from "../values/pixels.js";
import { finiteNumbers, flattened, record } from "../values/validation.js";

/** The output of MoGe, with tensors as arrays. */
export interface MogeOutput extends ImageSize {
  /** x, y, z per pixel, in the OpenCV camera frame; infinite if the model predicts no surface. */
  points: Float32Array;
  /** Non-zero (or true) for valid points. By default, all finite points with z above 0 are valid. */
  mask?: ArrayLike<number | boolean> | undefined;
  /** The 3×3 matrix for an image of width and height 1, row-major, nested or flat. */
  intrinsics?: ArrayLike<number> | readonly (readonly number[])[] | undefined;
}

/**
 * Converts a point map of MoGe for `align`: invalid points become NaN ("no reading"), and the intrinsics, which MoGe
 * returns for an image of 1 × 1, are converted to pixels. In MoGe, the corners of the image are at 0 and 1; in
 * sim3align, pixel centres have integer coordinates. Therefore cx becomes cx · width − 0.5.
 *
 * @param output points of MoGe-2 are metric, those of MoGe-1 have an unknown scale
 * @returns `pointMap`, and `camera` if there are intrinsics
 *
 * @example
 * const { pointMap, camera } = pointMapFromMoge({ points, mask: valid, intrinsics, width, height });
 * await aligner.align({ pointMap, camera, mask, mesh });
 * @throws {@link Sim3AlignError} for arrays of the wrong type or length
 */
export function pointMapFromMoge(output: MogeOutput): {
  pointMap: PixelArray<Float32Array>;
  camera: (PinholeCamera & ImageSize) | undefined;
} {
  const given = record("output", output, "{ points, width, height }");
  const { points, mask, intrinsics } = given;
  const size = sizeOf("output", given);
  const { data } = pixelsOf<Float32Array>("output", { ...size, data: points }, pointKinds, 3);
  const valid = mask === undefined ? undefined : isTypedArray<Uint8Array>(mask, "Uint8Array") ? mask : flattened(mask);
  if (valid !== undefined) checkCount("output.mask", valid?.length ?? 0, size);
  const pointMap = data.slice();
  for (let i = 0; i < pointMap.length; i += 3) {
    const point = pointMap.subarray(i, i + 3);
    const isReading = point.every(Number.isFinite) && (point[2] ?? 0) > 0;
    if (!isReading || (valid && !valid[i / 3])) point.fill(Number.NaN);
  }
  const camera = intrinsics === undefined ? undefined : { ...inPixels(intrinsics, size), ...size };
  return { pointMap: { data: pointMap, ...size }, camera };
}

function inPixels(intrinsics: unknown, { width, height }: ImageSize) {
  const K = finiteNumbers("output.intrinsics", intrinsics, 9, "nine finite numbers, row-major");
  const { fx, fy, cx, cy } = pinholeOf("output.intrinsics", { K });
  return { fx: fx * width, fy: fy * height, cx: cx * width - 0.5, cy: cy * height - 0.5 };
}
