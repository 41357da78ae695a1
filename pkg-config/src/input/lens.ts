/** Cameras whose intrinsics were not given. */
import type { ExifFocal } from "../camera/exif-focal.js";
import type { Pinhole } from "../camera/pinhole.js";
import type { Warning } from "../generated/types.js";
import type { Exif } from "../types/files.js";
import type { ImageSize } from "../values/pixels.js";

/**
 * The focal length of an image of which nothing is known, relative to its longer side, and the standard deviation of its
 * logarithm: main cameras of phones (24 to 28 mm on full frame) to standard lenses (50 mm).
 */
const UNKNOWN_LENS = { focal: 0.87, deviation: 0.3 } as const;

const unknownLens =
  "No camera was given, and neither the depth file nor the photo states a focal length: it was estimated. Pass the camera, the depth file as the model wrote it, or the photo as the camera wrote it.";

/** The camera by the files of a view. */
export interface CameraHints {
  /** The camera in the depth file. */
  inDepth?: Pinhole | undefined;
  /** The focal length in the EXIF data of the photo, and its size. */
  photo?: (ExifFocal & { size: ImageSize }) | undefined;
}

/** What the EXIF data of a photo of this size state. */
export async function photoHint(
  exif: Exif | undefined,
  size: ImageSize | null | undefined,
): Promise<CameraHints["photo"]> {
  if (!exif || !size) return undefined;
  const { focalFrom } = await import("../camera/exif-focal.js");
  const focal = focalFrom(exif, size);
  return focal && { ...focal, size };
}

/** A camera that was not given. */
export interface FoundCamera {
  camera: Pinhole;
  /** Standard deviation of the logarithm of the focal length; `undefined` where it is known. */
  focalDeviation: number | undefined;
  /** The source of the intrinsics, for people. */
  source: string;
  warnings: readonly Warning[];
}

/** The camera of a depth map of this size: that in its file, else that of the photo, else a common lens. */
export function foundCamera({ width, height }: ImageSize, { inDepth, photo }: CameraHints): FoundCamera {
  if (inDepth !== undefined) return { camera: inDepth, focalDeviation: undefined, source: "depth file", warnings: [] };
  const center = { cx: 0.5 * (width - 1), cy: 0.5 * (height - 1) };
  if (photo !== undefined) {
    const { focalPx, uncertainty: focalDeviation, source, size } = photo;
    const [fx, fy] = [(focalPx * width) / size.width, (focalPx * height) / size.height];
    return { camera: { fx, fy, ...center }, focalDeviation, source, warnings: [] };
  }
  const focal = UNKNOWN_LENS.focal * Math.max(width, height);
  return {
    camera: { fx: focal, fy: focal, ...center },
    focalDeviation: UNKNOWN_LENS.deviation,
    source: "estimate",
    warnings: [{ code: "FOCAL_LENGTH_UNKNOWN", message: unknownLens }],
  };
}
