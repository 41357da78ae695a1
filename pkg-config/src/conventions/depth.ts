/** Depth in metres from the values of depth models. */
import { pinholeOf } from "../camera/pinhole.js";
import { depthOfRays } from "../camera/ray-distance.js";
import type { DepthCalibration } from "../generated/types.js";
import type { CameraInput } from "../types/inputs.js";
import { plainArgument } from "../values/border.js";
import { type PixelArray, pixelsOf, pointKinds } from "../values/pixels.js";
import { finite, positive, record } from "../values/values.js";

/** See `src/calibrate/calibration.rs`. */
const FARTHEST = 1e3;

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
  const image = pixelsOf<Float32Array>("disparity", disparity, pointKinds);
  const given = record("calibration", calibration, "{ scale, shift? }");
  const scale = finite("calibration.scale", given.scale);
  const shift = finite("calibration.shift", given.shift ?? 0);
  return metresOf(image, (d) => 1 / (scale * d + shift));
}

/**
 * Converts distances from the camera's centre, along the ray of each pixel, to depth along its optical axis. `align` does it
 * itself with `depthKind: "ray-distance"`.
 * @param distances as `{ data, width, height }`
 * @param camera intrinsics in pixels of these
 * @returns depth in the unit of the distances
 *
 * @example
 * const depth = depthFromRayDistance({ data: rangeImage, width, height }, { fx, fy, cx, cy });
 * @throws {@link Sim3AlignError} for arrays of the wrong type or length, and for a camera that is none
 */
export function depthFromRayDistance(
  distances: PixelArray<Float32Array>,
  camera: CameraInput,
): PixelArray<Float32Array> {
  const { data, width, height } = pixelsOf<Float32Array>("distances", distances, pointKinds);
  const pinhole = pinholeOf("camera", plainArgument("camera", camera), { width, height });
  return { data: depthOfRays(data, width, pinhole), width, height };
}

/**
 * The depth map of a calibration, in which the poses of its result are: z = s·d for metric and scale-invariant depth d,
 * s·(d + t) for affine-invariant depth, s / (d + t) for affine-invariant disparity, of at most 1000·s. Metres, if the
 * calibration `isMetric`.
 * @param depth values as they were passed as `depth` (integers times `depthScale`, where one was given)
 * @param calibration `depthCalibration` of the result
 * @returns 0 where there is no reading
 * @throws {@link Sim3AlignError} for arrays of the wrong type or length, and for a calibration that is none
 */
export function correctDepth(
  depth: PixelArray<Float32Array | Uint16Array | Uint8Array>,
  calibration: DepthCalibration,
): PixelArray<Float32Array> {
  const image = pixelsOf<Float32Array>("depth", depth, ["Float32Array", "Uint16Array", "Uint8Array"]);
  const { depthKind, ...given } = record("calibration", calibration, "depthCalibration of a result");
  const [scale, shift] = [positive("calibration.scale", given.scale), finite("calibration.shift", given.shift)];
  return metresOf(image, (d) => {
    if (depthKind === "affine-invariant") return (d + shift) * scale;
    if (depthKind === "affine-invariant-disparity") return scale / Math.max(d + shift, scale / FARTHEST);
    return d * scale;
  });
}

/** The depth of each pixel; 0 where it is not a number above 0. */
function metresOf(
  { data, width, height }: PixelArray<Float32Array>,
  depthOf: (value: number) => number,
): PixelArray<Float32Array> {
  const metres = Float32Array.from(data, (value) => {
    const z = depthOf(value);
    return Number.isFinite(z) && z > 0 ? z : 0;
  });
  return { data: metres, width, height };
}
