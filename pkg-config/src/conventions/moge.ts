/** What MoGe returns: a point map, a mask of what is valid, and normalised intrinsics. */

import { pinholeOf } from "../formats/pinhole.js";
import { checkCount, type ImageSize, pixelsOf, pointKinds, sizeOf } from "../formats/pixels.js";
import type { PinholeCamera, PixelArray } from "../input/types.js";
import { finiteNumbers, flattened, isTypedArray, record } from "../values.js";

/** MoGe's output, its tensors as arrays. */
export interface MogeOutput extends ImageSize {
  /** x, y, z per pixel, in the OpenCV camera frame; infinite where the model sees no surface. */
  points: Float32Array;
  /** Non-zero (or true) where the point is valid. By default every finite point with z above 0 is. */
  mask?: ArrayLike<number | boolean> | undefined;
  /** The 3×3 matrix for an image of width and height 1, row by row, nested or not. */
  intrinsics?: ArrayLike<number> | readonly (readonly number[])[] | undefined;
}

/**
 * A point map as `align` takes it, from MoGe's: invalid points become NaN, "no reading", and the intrinsics, which MoGe
 * gives for an image of 1 × 1, become pixels. MoGe's image goes from edge to edge of the outer pixels, while pixel
 * centres are at whole numbers here, so that cx is its cx times the width, minus a half.
 *
 * @param output MoGe-2's points are metric, MoGe-1's are up to a factor
 * @returns `pointMap`, and `camera` where there were intrinsics
 *
 * @example
 * const { pointMap, camera } = pointMapFromMoge({ points, mask: valid, intrinsics, width, height });
 * await aligner.align({ pointMap, camera, mask, mesh });
 * @throws {@link Sim3AlignError} for arrays of other kinds or lengths
 */
export function pointMapFromMoge(output: MogeOutput): {
  pointMap: PixelArray<Float32Array>;
  camera: (PinholeCamera & ImageSize) | undefined;
} {
  const { points, mask, intrinsics } = record("output", output, "{ points, width, height }");
  const size = sizeOf("output", output);
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
  const K = finiteNumbers("output.intrinsics", intrinsics, 9, "nine finite numbers, row by row");
  const { fx, fy, cx, cy } = pinholeOf("output.intrinsics", { K });
  return { fx: fx * width, fy: fy * height, cx: cx * width - 0.5, cy: cy * height - 0.5 };
}
