/** Depth maps with their calibration. */
import { checkAttached } from "../attached.js";
import type { DepthCalibration } from "../generated/types.js";
import { finite, isTypedArray, positive, record, wrongKind } from "../values.js";

/** See `src/calibrate/calibration.rs`. */
const FARTHEST = 1e3;

/**
 * The depth map of a calibration, in which the poses of its result are: z = s·d for metric and scale-invariant depth d,
 * s·(d + t) for affine-invariant depth, s / (d + t) for affine-invariant disparity, of at most 1000·s. Metres, if the
 * calibration `isMetric`.
 * @param values as they were passed as `depth` (integers times `depthScale`, where one was given)
 * @returns 0 where there is no reading
 * @throws {@link Sim3AlignError} `INVALID_ARGUMENT`
 */
export function correctDepth(
  values: Float32Array | Uint16Array | Uint8Array,
  calibration: DepthCalibration,
): Float32Array {
  if (!isTypedArray<Float32Array>(values, "Float32Array", "Uint16Array", "Uint8Array")) {
    throw wrongKind("values", values, "a Float32Array, a Uint16Array or a Uint8Array", "Float32Array");
  }
  checkAttached("values", values);
  const { depthKind, ...given } = record("calibration", calibration, "depthCalibration of a result");
  const [scale, shift] = [positive("calibration.scale", given.scale), finite("calibration.shift", given.shift)];
  const depth = (d: number): number => {
    if (depthKind === "affine-invariant") return (d + shift) * scale;
    if (depthKind === "affine-invariant-disparity") return scale / Math.max(d + shift, scale / FARTHEST);
    return d * scale;
  };
  return Float32Array.from(values, (d) => {
    const z = depth(d);
    return Number.isFinite(z) && z > 0 ? z : 0;
  });
}
