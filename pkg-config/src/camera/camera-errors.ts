/** Errors about camera files. */
import { failure } from "../values/error.js";

/** The names of a camera file and of its options in errors. */
export interface CameraFileNames {
  file: string;
  /** Prefix of the names of options. */
  options: "" | "options.";
}

const forms =
  "{ fx, fy, cx, cy }, { K } or another name of a 3 × 3, 3 × 4 or 4 × 4 matrix, { fovYDeg }, a BOP scene_camera.json, or the numbers as text";

/** The error for JSON that is not the content of a camera file. */
export function noCamera({ file }: Pick<CameraFileNames, "file">, found: string) {
  const remedy = "Write the focal lengths and the principal point as fx, fy, cx and cy, in pixels of the depth map.";
  return failure("INVALID_CAMERA", file, found, forms, remedy);
}

/** The error for intrinsics that depend on the size of the image. */
export function withoutSize(found: string, { options }: CameraFileNames) {
  const remedy = "Pass the width and height of the depth map in pixels.";
  return failure("INVALID_ARGUMENT", `${options}width`, `${found} without image size`, "width and height", remedy);
}
