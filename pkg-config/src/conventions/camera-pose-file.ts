/** Files of camera poses. */
import { failure } from "../values/error.js";
import { type JsonFile, shown } from "../values/json.js";
import { isRecord } from "../values/kinds.js";
import { openGlAxes } from "./frames.js";
import { columnMajor, poseJson } from "./pose-file.js";
import { composed, inverted, type Similarity, sim3Of, similarityOf } from "./similarity.js";

/** The names of a 4 × 4 matrix, and how it becomes world from camera (OpenCV). */
const conventions: readonly { names: readonly string[]; read: (pose: Similarity) => Similarity }[] = [
  {
    names: ["camera_to_world", "cameraToWorld", "cam2world", "c2w", "world_from_camera", "camera_pose", "pose"],
    read: (pose) => pose,
  },
  {
    names: ["world_to_camera", "worldToCamera", "world2cam", "w2c", "camera_from_world", "extrinsic", "extrinsics"],
    read: inverted,
  },
  // nerfstudio, instant-ngp and Blender: the axes of OpenGL.
  {
    names: ["transform_matrix"],
    read: (pose) => composed(pose, openGlAxes),
  },
];

/**
 * The pose of a frame's camera, world from camera in metres, column-major: the rows of a 4 × 4 matrix as text, or by one of these
 * names in JSON.
 */
export function parseCameraPose(argument: string, content: JsonFile): number[] {
  const json = poseJson(argument, content);
  const entry = isRecord(json) ? json : { pose: json };
  for (const { names, read } of conventions) {
    const name = names.find((each) => each in entry);
    const matrix = name === undefined ? null : columnMajor(entry[name]);
    if (name === undefined) continue;
    if (matrix === null) throw notPose(argument, shown(entry[name]));
    return sim3Of(read(similarityOf(matrix, argument))).matrix;
  }
  throw notPose(argument, shown(json));
}

function notPose(argument: string, found: string) {
  const expected = '{ "camera_to_world": 4 × 4 numbers, row by row }, or these numbers as text';
  const remedy = "The matrix maps points of the camera (x right, y down, z forward) to the world, in metres.";
  return failure("CORRUPT_FILE", argument, found, expected, remedy);
}
