/** Camera frames of other tools. */
import type { Sim3, Sim3Like } from "../input/sim3.js";
import { oneOf, optionsOf, type Quaternion, type Vector3 } from "../values/values.js";
import { type Matrix3, transposed } from "./rotation.js";
import { composed, type Similarity, sim3Of, similarityOf } from "./similarity.js";

/**
 * A camera frame, named by its users. All are right-handed.
 *
 * | | x | y | z |
 * |---|---|---|---|
 * | `opencv` (RealSense, BOP, ROS optical frames, MoGe; this package) | right | down | forward |
 * | `opengl` (three.js, glTF, Blender) | right | up | backward |
 * | `pytorch3d` (SAM 3D Objects) | left | up | forward |
 * | `ros` (REP-103 body) | forward | left | up |
 */
export type CameraFrame = "opencv" | "opengl" | "pytorch3d" | "ros";

/** Rotation matrices (row-major) from the OpenCV camera frame to each frame. */
const turns: Readonly<Record<CameraFrame, Matrix3>> = {
  opencv: [1, 0, 0, 0, 1, 0, 0, 0, 1],
  opengl: [1, 0, 0, 0, -1, 0, 0, 0, -1],
  pytorch3d: [-1, 0, 0, 0, -1, 0, 0, 0, 1],
  ros: [0, 0, 1, -1, 0, 0, 0, -1, 0],
};

/** The names of the frames. */
export const cameraFrames = Object.keys(turns) as readonly CameraFrame[];

const rotationOnly = (rotation: Matrix3): Similarity => ({ scale: 1, rotation, translation: [0, 0, 0] });

/** The rotation from the OpenCV camera frame to the frame. */
export const turnTo = (argument: string, frame: CameraFrame) => turns[oneOf(argument, frame, cameraFrames)];

/** Converts a similarity to the other frame. */
export const inFrame = (argument: string, similarity: Similarity, frame: CameraFrame): Similarity =>
  composed(rotationOnly(turnTo(argument, frame)), similarity);

/**
 * Converts a transform to the OpenCV camera frame into one to another camera frame.
 *
 * @param transform a transform to the OpenCV camera frame, such as a result of `align`
 * @param frame the target camera frame
 * @returns the transform to that camera frame, in all forms; scale and units are unchanged
 *
 * @example
 * toFrame(result, "opengl").matrix;    // for three.js, glTF, Blender: diag(1, −1, −1) times the transform
 * @throws {@link Sim3AlignError} if the transform is not a similarity, and `INVALID_OPTION` for an unknown frame
 */
export const toFrame = (transform: Sim3Like, frame: CameraFrame): Sim3 =>
  sim3Of(inFrame("frame", similarityOf(transform), frame));

/**
 * The inverse of {@link toFrame}: converts a transform to some camera frame into one to the OpenCV camera frame, for
 * `evaluate` and the option `initial`.
 *
 * @example
 * await aligner.align(input, { initial: fromFrame(posedInThree, "opengl"), search: "local" });
 * @throws {@link Sim3AlignError} as {@link toFrame}
 */
export const fromFrame = (transform: Sim3Like, frame: CameraFrame): Sim3 =>
  sim3Of(composed(rotationOnly(transposed(turnTo("frame", frame))), similarityOf(transform)));

/** The pose of a three.js object. */
export interface ThreePose {
  /** For `object.matrix.fromArray(…)`, with `object.matrixAutoUpdate = false`. */
  matrix: number[];
  /** For `object.position.set(…)`. */
  position: Vector3;
  /** For `object.quaternion.set(…)`: x, y, z, w. */
  quaternion: Quaternion;
  /** For `object.scale.set(…)`: three equal values. */
  scale: Vector3;
}

/**
 * The pose of the mesh as a child of a three.js camera, or in a scene whose camera is at the origin without rotation:
 * OpenGL camera frame, metres. `applyToObject3D` in `sim3align/three` applies it to an object.
 *
 * @example
 * const { position, quaternion, scale } = toThree(result);
 * object.position.set(...position);
 * object.quaternion.set(...quaternion);
 * object.scale.set(...scale);
 * @throws {@link Sim3AlignError} if the transform is not a similarity
 */
export function toThree(transform: Sim3Like): ThreePose {
  const { matrix, scale, rotation, translation } = toFrame(transform, "opengl");
  return { matrix, position: translation, quaternion: rotation, scale: [scale, scale, scale] };
}

/** A pose in the form of ROS' geometry_msgs/Pose, and the scale, which that message lacks. */
export interface RosPose {
  /** Metres. */
  position: { x: number; y: number; z: number };
  orientation: { x: number; y: number; z: number; w: number };
  /** Metres per mesh unit: multiply the mesh by it (`visualization_msgs/Marker.scale`). */
  scale: number;
}

/**
 * Converts a transform to a pose for ROS: in the camera's REP-103 body frame (x forward, y left, z up) or, with `frame:
 * "optical"`, in its optical frame (z forward, x right, y down), which is OpenCV's.
 *
 * @example
 * const { position, orientation, scale } = toRos(result);    // header.frame_id: "camera_link"
 * @throws {@link Sim3AlignError} if the transform is not a similarity, and `INVALID_OPTION` for another frame
 */
export function toRos(transform: Sim3Like, options: { frame?: "body" | "optical" } = {}): RosPose {
  const { frame = "body" } = optionsOf(options, ["frame"]);
  const isBody = oneOf("options.frame", frame, ["body", "optical"]) === "body";
  const { rotation, translation, scale } = toFrame(transform, isBody ? "ros" : "opencv");
  const [[x, y, z], [qx, qy, qz, qw]] = [translation, rotation];
  return { position: { x, y, z }, orientation: { x: qx, y: qy, z: qz, w: qw }, scale };
}
