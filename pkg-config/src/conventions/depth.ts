/** Depth in metres from the values of depth models. */
import { depthOfRays, pinholeOf } from "../camera/pinhole.js";
import { depthKindNames } from "../input/formats.js";
import type { CameraInput, DepthKind } from "../types/inputs.js";
import { type PixelArray, pixelsOf } from "../values/pixels.js";
import { finite, oneOf, positive, record } from "../values/validation.js";

/** See `src/calibrate/calibration.rs`. */
const FARTHEST = 1e3;

/** How to convert the values of a depth map to depth: `depthCalibration` of a result, or facts of a camera. */
export interface DepthCorrection {
  depthKind: DepthKind;
  /** Above 0; 1 by default. */
  scale?: number | undefined;
  /** 0 by default. */
  shift?: number | undefined;
  /** For `"ray-distance"`: intrinsics in pixels of the depth map. */
  camera?: CameraInput | undefined;
}

/**
 * The depth along the optical axis, from the values of a depth map: z = s·d for metric and scale-invariant depth d,
 * s·(d + t) for affine-invariant depth, s / (d + t) for affine-invariant disparity, of at most 1000·s, and s times the
 * distance along the ray times the cosine of its angle for ray distances. Metres, if scale and shift are: those of a
 * calibration that `isMetric`, or of a stereo camera, whose `scale` is focal length in pixels · baseline in metres.
 * @param depth values as they were passed as `depth` (integers times `depthScale`, where one was given)
 * @param correction `depthCalibration` of the result, in whose depth map its poses are; or `{ depthKind, scale, shift, camera }`
 * @returns 0 where there is no reading
 *
 * @example
 * const metres = correctDepth(disparity, { depthKind: "affine-invariant-disparity", scale: fx * baselineM });
 * @throws {@link Sim3AlignError} for arrays of the wrong type or length, and for a correction that is none
 */
export function correctDepth(
  depth: PixelArray<Float32Array | Uint16Array | Uint8Array>,
  correction: DepthCorrection,
): PixelArray<Float32Array> {
  const image = pixelsOf<Float32Array>("depth", depth, ["Float32Array", "Uint16Array", "Uint8Array"]);
  const given = record("correction", correction, "depthCalibration of a result");
  const depthKind = oneOf("correction.depthKind", given.depthKind, depthKindNames, "INVALID_ARGUMENT");
  const [scale, shift] = [positive("correction.scale", given.scale ?? 1), finite("correction.shift", given.shift ?? 0)];
  if (depthKind === "ray-distance") {
    const pinhole = pinholeOf("correction.camera", given.camera, image);
    return { ...image, data: depthOfRays(image.data, image.width, pinhole, scale) };
  }
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
