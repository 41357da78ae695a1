/** Poses of a mesh: camera from mesh, OpenCV camera frame, metres. */

import { compose, type Sim3, toSim3, type Vector3 } from "sim3align/conventions";
import { type Bounds, placed } from "./bounds.js";

/** What put the mesh where it is. */
export type PoseSource = "start" | "aligned" | "alternative" | "refined" | "hand";

/** A pose, and where it comes from; never changed, only replaced. */
export interface Pose {
  readonly transform: Sim3;
  readonly source: PoseSource;
  /** Which of the alternatives it is, from 0 on. */
  readonly alternative?: number;
}

/** The quaternion of a turn about an axis of the camera's frame. */
export function turn(axis: Vector3, degrees: number): [number, number, number, number] {
  const half = (degrees * Math.PI) / 360;
  const [x, y, z] = axis;
  return [x * Math.sin(half), y * Math.sin(half), z * Math.sin(half), Math.cos(half)];
}

/** What a nudge does, about the object's centre. */
export interface Nudge {
  moveM?: Vector3;
  rotation?: [number, number, number, number];
  scale?: number;
}

/** The pose after a nudge. */
export function nudged(
  centerM: Vector3,
  from: Sim3,
  { moveM = [0, 0, 0], rotation = [0, 0, 0, 1], scale = 1 }: Nudge,
): Sim3 {
  const still = [0, 0, 0, 1];
  const away = { scale: 1, rotation: still, translation: centerM.map((x) => -x) };
  const back = { scale: 1, rotation: still, translation: centerM.map((x, k) => x + (moveM[k] ?? 0)) };
  return compose(back, { scale, rotation, translation: [0, 0, 0] }, away, from);
}

/**
 * Where nobody has aligned anything yet: the mesh upright, as in glTF, in the object's middle, about as large as what is
 * seen of it.
 */
export function startPose(bounds: Bounds, middleM: Vector3, sizeM: number): Sim3 {
  const scale = sizeM / (Math.hypot(...bounds.sides) || 1);
  const upright = toSim3({ scale, rotation: [1, 0, 0, 0], translation: [0, 0, 0] });
  const { centerM } = placed(bounds, upright);
  const translation = middleM.map((x, k) => x - (centerM[k] ?? 0)) as Vector3;
  return toSim3({ scale, rotation: [1, 0, 0, 0], translation });
}
