/** Flags of all commands that control how a case is read. */
import { type Command, Option } from "commander";
import type { ReadCaseOptions } from "../case-folder.js";
import { type DepthKind, depthKinds } from "../input/types.js";
import { withoutUndefined } from "../values/values.js";
import { number } from "./parse.js";

/** Values of the flags. */
export interface CaseFlags {
  depthScale?: number;
  depthKind?: DepthKind;
  imageId?: string;
  resizeMask?: "nearest";
  image?: string | boolean;
}

/** Adds the flags to a command. */
export function addCaseOptions(command: Command): Command {
  return command
    .option("--depth-scale <metres>", "metres per unit of depth, such as 0.001 for millimetres", number)
    .addOption(
      new Option("--depth-kind <kind>", "what the values of the depth map are (default metric)").choices(depthKinds),
    )
    .option("--image-id <id>", "image id in a BOP scene_camera.json")
    .option("--no-image", "do not read the photo: align by shape alone")
    .addOption(new Option("--resize-mask <how>", "resize the mask to the size of the depth map").choices(["nearest"]));
}

/** Converts the flags to settings of a case. */
export const caseSettings = ({ depthScale, depthKind, imageId, resizeMask, image }: CaseFlags): ReadCaseOptions =>
  withoutUndefined({ depthScale, depthKind, imageId, resizeMask, image: image === false ? false : undefined });

/** The layout of a case folder, for --help. */
export const caseFolderHelp = `
A case folder holds
  depth.npy, .png, .npz, .exr, .tiff or .pfm
                                 z-depth; floats are metres, whole numbers (16-bit PNG) millimetres unless
                                 --depth-scale or the camera file says otherwise; 0 and NaN are "no reading";
                                 --depth-kind for what depth models guess without a unit
  mask.png, .npy or .json        non-zero is the object; JSON is COCO RLE {"size": [h, w], "counts": …}
  mesh.glb, .gltf, .obj, .ply or .stl
                                 the object in its own frame, in any unit
  camera.json (optional)         {"fx", "fy", "cx", "cy"}, {"K"}, {"fovYDeg"}, or ROS CameraInfo; or BOP's
                                 scene_camera.json; without it, the camera is that of the depth file or of the EXIF data
                                 of the photo, or the focal length is estimated
  rgb.png or .jpg, image.png or .jpg (optional)
                                 the photo, registered to the depth map; compared with the colours of the mesh
  gt.json (optional)             {"scale", "rotation": 3×3 row-major, "translation": m, "symmetry"}: the true pose
or a mesh and folders frame_*, each with depth, and optionally
  camera.json                    as above
  mask.png, .npy or .json        in at least one frame; in all of them without pose.json
  rgb.png or .jpg, image.png or .jpg
                                 the photo of the frame
  pose.json                      {"camera_to_world": 4×4 row by row, m}: the camera's pose; in all frames or it is not used`;

/** Frames and units, for --help. */
export const conventionsHelp = `
Frames and units
  x_cam = s·R·p_mesh + t. The camera looks along +z, x is right, y is down (OpenCV); metres. Pixel centres are at
  whole numbers. "matrix" is column-major (three.js, glTF), "rotation" row-major, "quaternion" x, y, z, w.`;

/** Depth without a unit, for --help. */
export const depthKindHelp = `
Depth of models
  --depth-kind says what the values are: metric, scale-invariant (times an unknown factor), affine-invariant (times an
  unknown factor, plus an unknown shift) or affine-invariant-disparity (the same of the inverse depth; near is large).
  Factor and shift are estimated with the pose. Lengths are then metric only if one is known: --known-extent, or a number
  as --scale. Otherwise they are in units of their own, also in JSON and in GLB files, and "depthCalibration" of the JSON
  entry has { "isMetric": false }; columns in metres and millimetres are empty, and errors against gt.json are not measured.`;

/** The meaning of the exit status, for --help. */
export const statusHelp = `
Exit status: 0 all cases done, 1 some case failed (the others are done), 2 the command line is wrong, 130 interrupted
by Ctrl-C.`;
