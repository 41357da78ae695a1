/** How depth files are read, and what comes of it. */
import type { DepthKind } from "./depth-kind.js";
import type { PinholeCamera, PixelArray } from "./types.js";

/** How the values of a depth map are read. */
export interface ReadDepthOptions {
  /** Metres per unit. */
  depthScale?: number | undefined;
  /** Metres per unit of integers, where there is no `depthScale`: that of a camera file. */
  integerDepthScale?: number | undefined;
  /** What the values are; `"metric"` by default. */
  depthKind?: DepthKind | undefined;
}

/**
 * A depth map from a file, row-major: metres along the optical axis, 0 is "no reading". For another `depthKind` than
 * `"metric"`, the values are those of the file; for the affine-invariant kinds, "no reading" is NaN.
 */
export interface DepthImage extends PixelArray<Float32Array> {
  /** The unit of the values in the file, and why it was taken: `"0.001 m (16-bit integers, assumed)"`. */
  unit: string;
  /** The camera in the file, in pixels of the depth map: from its intrinsics, its focal length or its field of view. */
  camera?: PinholeCamera;
}
