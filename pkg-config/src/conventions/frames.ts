/** Camera frames of other tools. */
import type { Sim3, Sim3Like } from "../input/sim3.js";
import { oneOf } from "../values/validation.js";
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
const cameraFrames = Object.keys(turns) as readonly CameraFrame[];

const rotationOnly = (rotation: Matrix3): Similarity => ({ scale: 1, rotation, translation: [0, 0, 0] });

/** The rotation from the OpenCV camera frame to the frame. */
export const turnTo = (argument: string, frame: CameraFrame) => turns[oneOf(argument, frame, cameraFrames)];

/** The axes of OpenGL: camera from OpenGL's camera, which is its own inverse. */
export const openGlAxes: Similarity = rotationOnly(turns.opengl);

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
 * const { translation, rotation, scale } = toFrame(result, "ros");    // position and orientation of a geometry_msgs/Pose
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
