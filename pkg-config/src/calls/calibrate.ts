/** Views whose depth or focal length is not fully known: they are calibrated before their objects are aligned. */

import { intrinsics } from "../input/camera.js";
import { isAffineInvariant } from "../input/formats.js";
import type { CoreFrame } from "../modules/core-input.js";
import type { Calibrated } from "../modules/exports.js";
import { invalidArgument } from "../values/error.js";
import { isRecord } from "../values/kinds.js";

/** Whether depth or focal length are not fully known. */
export const isRaw = ({ depthKind, focalDeviation }: Pick<CoreFrame, "depthKind" | "focalDeviation">): boolean =>
  depthKind !== undefined || focalDeviation !== undefined;

/** Whether an input that has not been read may be such a view. */
export const mayBeRaw = (input: unknown): boolean => {
  const { depthKind, camera, cameraFile } = isRecord(input) ? input : {};
  const { focalUncertainty, ...given } = isRecord(camera) ? camera : {};
  const hasCamera = cameraFile !== undefined || intrinsics.some((name) => given[name] !== undefined);
  return depthKind !== undefined || focalUncertainty !== undefined || !hasCamera;
};

/** The view in the depth and with the camera of its calibration, if it has one. */
export function inCalibration<V extends Omit<CoreFrame, "mask">>(view: V, calibrated: Calibrated | undefined): V {
  if (calibrated === undefined) return view;
  const { depth, calibration } = calibrated;
  const { depthScale: _, depthKind: __, focalDeviation: ___, pointMap: ____, ...rest } = view;
  return { ...rest, depth, camera: calibration.camera, uncertainty: calibration.uncertainty } as unknown as V;
}

/**
 * Checks that lengths can be measured in a view.
 * @throws {@link Sim3AlignError} `INVALID_ARGUMENT` for depth with an unknown shift, or an unknown focal length
 */
export function checkMeasurable({ depthKind, focalDeviation, camera }: CoreFrame): void {
  if (isAffineInvariant(depthKind)) {
    const remedy =
      "Pass the depth that correctDepth() of sim3align/conventions makes with the calibration of a result.";
    throw invalidArgument("depthKind", depthKind, "depth without an unknown shift", remedy);
  }
  if (focalDeviation === undefined) return;
  const remedy = "Pass the camera of the calibration of a result.";
  throw invalidArgument("camera", camera, "a camera whose focal length is known", remedy);
}
