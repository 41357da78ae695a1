/** The frames that cameras are described in. */
import type { Sim3, Sim3Like } from "../sim3.js";
import { oneOf, type Quaternion, type Vector3 } from "../values.js";
import { type Matrix3, transposed } from "./rotation.js";
import { composed, type Similarity, sim3Of, similarityOf } from "./similarity.js";

/**
 * A camera frame, by who uses it. All are right-handed.
 *
 * | | x | y | z |
 * |---|---|---|---|
 * | `opencv` (RealSense, BOP, ROS optical frames, MoGe; this package) | right | down | forward |
 * | `opengl` (three.js, glTF, Blender) | right | up | backward |
 * | `pytorch3d` (SAM 3D Objects) | left | up | forward |
 * | `ros` (REP-103 body) | forward | left | up |
 */
export type CameraFrame = "opencv" | "opengl" | "pytorch3d" | "ros";

/** The rows that turn a point of the OpenCV camera frame into the other one. */
const turns: Readonly<Record<CameraFrame, Matrix3>> = {
  opencv: [1, 0, 0, 0, 1, 0, 0, 0, 1],
  opengl: [1, 0, 0, 0, -1, 0, 0, 0, -1],
  pytorch3d: [-1, 0, 0, 0, -1, 0, 0, 0, 1],
  ros: [0, 0, 1, -1, 0, 0, 0, -1, 0],
};

/** The names of the frames. */
export const cameraFrames = Object.keys(turns) as readonly CameraFrame[];

const rotationOnly = (rotation: Matrix3): Similarity => ({ scale: 1, rotation, translation: [0, 0, 0] });

/** frame from OpenCV. */
export const turnTo = (argument: string, frame: CameraFrame) => turns[oneOf(argument, frame, cameraFrames)];

/** A similarity that leads into the other frame. */
export const inFrame = (argument: string, similarity: Similarity, frame: CameraFrame): Similarity =>
  composed(rotationOnly(turnTo(argument, frame)), similarity);

/**
 * A transform into the OpenCV camera frame, turned into another camera frame.
 *
 * @param transform OpenCV camera from anything: a result of `align`
 * @param frame the frame to turn it into
 * @returns that camera frame from the same thing, in all forms; scale and units stay
 *
 * @example
 * toFrame(result, "opengl").matrix;    // for a camera that looks along −z
 * @throws {@link Sim3AlignError} for what is no similarity, and `INVALID_OPTION` for a frame that does not exist
 */
export const toFrame = (transform: Sim3Like, frame: CameraFrame): Sim3 =>
  sim3Of(inFrame("frame", similarityOf(transform), frame));

/**
 * The inverse of {@link toFrame}: a transform into some camera frame, turned into the OpenCV camera frame, as
 * `evaluate` and the option `initial` take it.
 *
 * @example
 * await aligner.align(input, { initial: fromFrame(posedInThree, "opengl"), search: "local" });
 * @throws {@link Sim3AlignError} as {@link toFrame}
 */
export const fromFrame = (transform: Sim3Like, frame: CameraFrame): Sim3 =>
  sim3Of(composed(rotationOnly(transposed(turnTo("frame", frame))), similarityOf(transform)));

/**
 * The transform for a camera of OpenGL's kind (three.js, glTF, Blender): x right, y up, looking along −z. It is
 * `diag(1, −1, −1)` times the transform.
 *
 * @returns `matrix` (16 numbers column by column), `scale`, `rotation` (x, y, z, w), `rotationMatrix`, `translation`
 *
 * @example
 * toOpenGL(result).translation[2];    // below 0: in front of the camera
 * @throws {@link Sim3AlignError} as {@link toFrame}
 */
export const toOpenGL = (transform: Sim3Like): Sim3 => toFrame(transform, "opengl");

/** What an object of three.js is posed with. */
export interface ThreePose {
  /** For `object.matrix.fromArray(…)`, with `object.matrixAutoUpdate = false`. */
  matrix: number[];
  /** For `object.position.set(…)`. */
  position: Vector3;
  /** For `object.quaternion.set(…)`: x, y, z, w. */
  quaternion: Quaternion;
  /** For `object.scale.set(…)`: three times the same. */
  scale: Vector3;
}

/**
 * The pose of the mesh as a child of a three.js camera, or of a scene whose camera is at the origin, unturned: the
 * OpenGL camera frame, metres. For the whole step, see `applyToObject3D` in `sim3align/three`.
 *
 * @example
 * const { position, quaternion, scale } = toThree(result);
 * object.position.set(...position);
 * object.quaternion.set(...quaternion);
 * object.scale.set(...scale);
 * @throws {@link Sim3AlignError} for what is no similarity
 */
export function toThree(transform: Sim3Like): ThreePose {
  const { matrix, scale, rotation, translation } = toOpenGL(transform);
  return { matrix, position: translation, quaternion: rotation, scale: [scale, scale, scale] };
}

/** A pose as ROS' geometry_msgs/Pose has it, and the scale, which that has not. */
export interface RosPose {
  /** Metres. */
  position: { x: number; y: number; z: number };
  orientation: { x: number; y: number; z: number; w: number };
  /** Metres per mesh unit: multiply the mesh by it (`visualization_msgs/Marker.scale`). */
  scale: number;
}

/**
 * A pose for ROS: in the camera's body frame after REP-103 (x forward, y left, z up), or with `frame: "optical"` in its
 * optical frame (z forward, x right, y down), which is OpenCV's.
 *
 * @example
 * const { position, orientation, scale } = toRos(result);    // header.frame_id: "camera_link"
 * @throws {@link Sim3AlignError} for what is no similarity, and `INVALID_OPTION` for another frame
 */
export function toRos(transform: Sim3Like, { frame = "body" }: { frame?: "body" | "optical" } = {}): RosPose {
  const isBody = oneOf("options.frame", frame, ["body", "optical"]) === "body";
  const { rotation, translation, scale } = toFrame(transform, isBody ? "ros" : "opencv");
  const [[x, y, z], [qx, qy, qz, qw]] = [translation, rotation];
  return { position: { x, y, z }, orientation: { x: qx, y: qy, z: qz, w: qw }, scale };
}
