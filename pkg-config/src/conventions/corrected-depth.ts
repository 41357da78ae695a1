/** Depth maps with their calibration. */
import { pixelsOf } from "../formats/pixels.js";
import type { DepthCalibration } from "../generated/types.js";
import type { PixelArray } from "../input/types.js";
import { finite, positive, record } from "../values/values.js";

/** See `src/calibrate/calibration.rs`. */
const FARTHEST = 1e3;

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
  const { data, width, height } = pixelsOf<Float32Array>("depth", depth, ["Float32Array", "Uint16Array", "Uint8Array"]);
  const { depthKind, ...given } = record("calibration", calibration, "depthCalibration of a result");
  const [scale, shift] = [positive("calibration.scale", given.scale), finite("calibration.shift", given.shift)];
  const corrected = (d: number): number => {
    if (depthKind === "affine-invariant") return (d + shift) * scale;
    if (depthKind === "affine-invariant-disparity") return scale / Math.max(d + shift, scale / FARTHEST);
    return d * scale;
  };
  const metres = Float32Array.from(data, (d) => {
    const z = corrected(d);
    return Number.isFinite(z) && z > 0 ? z : 0;
  });
  return { data: metres, width, height };
}
