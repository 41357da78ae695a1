/** Depth from the output of relative depth models. */

import { pixelsOf, pointKinds } from "../formats/pixels.js";
import type { PixelArray } from "../input/types.js";
import { finite, record } from "../values/values.js";

/**
 * Converts relative inverse depth (disparity), the output of the relative models of Depth Anything and MiDaS, to depth
 * in metres: 1 / (scale · d + shift). Larger disparities are nearer.
 *
 * The model does not determine scale and shift: fit them to a few known distances. Without them, the depth is
 * distorted, and no similarity fits it. For a stereo camera, `scale` is 1 / (focal length in pixels · baseline in
 * metres), `shift` 0.
 *
 * @param disparity relative inverse depth, as `{ data, width, height }`
 * @param calibration `scale` and `shift`, both in 1/m
 * @returns depth in metres; 0 ("no reading") if the disparity is not finite or the depth is not above 0
 *
 * @example
 * const depth = depthFromDisparity(depthFromTensor(predicted_depth), { scale: 0.12, shift: 0.05 });
 * @throws {@link Sim3AlignError} for arrays of the wrong type or length, and for non-finite numbers
 */
export function depthFromDisparity(
  disparity: PixelArray<Float32Array>,
  calibration: { scale: number; shift?: number },
): PixelArray<Float32Array> {
  const { data, width, height } = pixelsOf<Float32Array>("disparity", disparity, pointKinds);
  const given = record("calibration", calibration, "{ scale, shift? }");
  const scale = finite("calibration.scale", given.scale);
  const shift = finite("calibration.shift", given.shift ?? 0);
  const depth = data.map((d) => {
    const metres = 1 / (scale * d + shift);
    return Number.isFinite(metres) && metres > 0 ? metres : 0;
  });
  return { data: depth, width, height };
}
