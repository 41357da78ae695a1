/** Depth from what relative depth models estimate. */

import { pixelsOf, pointKinds } from "../formats/pixels.js";
import type { PixelArray } from "../input/types.js";
import { finite } from "../values.js";

/**
 * Depth in metres from relative inverse depth (disparity), such as Depth Anything's and MiDaS' relative models
 * estimate, whose values are larger where it is nearer: 1 / (scale · d + shift).
 *
 * Scale and shift are not the model's to know: fit them to a few known distances. Without them the depth is bent, and
 * no similarity fits it. For a stereo camera, `scale` is 1 / (focal length in pixels · baseline in metres), `shift` 0.
 *
 * @param disparity relative inverse depth, as `{ data, width, height }`
 * @param calibration `scale` and `shift`, both in 1/m
 * @returns depth in metres; 0, "no reading", where the disparity is not finite or the depth not above 0
 *
 * @example
 * const depth = depthFromDisparity(depthFromTensor(predicted_depth), { scale: 0.12, shift: 0.05 });
 * @throws {@link Sim3AlignError} for arrays of other kinds or lengths, and numbers that are not finite
 */
export function depthFromDisparity(
  disparity: PixelArray<Float32Array>,
  calibration: { scale: number; shift?: number },
): PixelArray<Float32Array> {
  const { data, width, height } = pixelsOf<Float32Array>("disparity", disparity, pointKinds);
  const scale = finite("calibration.scale", calibration?.scale);
  const shift = finite("calibration.shift", calibration?.shift ?? 0);
  const depth = data.map((d) => {
    const metres = 1 / (scale * d + shift);
    return Number.isFinite(metres) && metres > 0 ? metres : 0;
  });
  return { data: depth, width, height };
}
