/** Views whose depth or focal length are not fully known, as they are given. */
import type { DepthCalibration, DepthKind, PinholeCamera } from "sim3align";

/** The intrinsics of a camera. */
export type Intrinsics = Pick<PinholeCamera, "fx" | "fy" | "cx" | "cy">;

/** What is given of a view whose depth or focal length are not fully known. */
export interface RawView {
  /** The values of the depth map. */
  readonly depth: Float32Array;
  readonly width: number;
  readonly height: number;
  readonly depthKind: DepthKind;
  readonly camera: Intrinsics;
  /** Relative standard deviation of the focal length; 0 if it is known. */
  readonly focalUncertainty: number;
  /** Warnings of the file readers. */
  readonly warnings: readonly string[];
}

/** What says whether depth has a unit. */
interface Depth {
  readonly raw: RawView | null;
  readonly calibration: DepthCalibration | null;
}

/** Whether lengths of a scene are metres. */
export const isMetric = ({ raw, calibration }: Depth): boolean =>
  calibration?.isMetric ?? (raw === null || raw.depthKind === "metric");
