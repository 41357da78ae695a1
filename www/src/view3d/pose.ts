/** Poses: similarities as 16 numbers, and what lies between two of them. */
import { toSim3 } from "sim3align/conventions";
import { Matrix4, Quaternion, Vector3 } from "three/webgpu";
import type { Matrix } from "./types.js";

/** A similarity in the terms of three.js. */
export interface Pose {
  position: Vector3;
  quaternion: Quaternion;
  scale: number;
}

/** The parts of a similarity; refuses what is none. */
export function poseOf(matrix: Matrix): Pose {
  const { scale, rotation, translation } = toSim3(matrix);
  return { position: new Vector3(...translation), quaternion: new Quaternion(...rotation), scale };
}

/** The 16 numbers of a pose, column by column. */
export function matrixOf({ position, quaternion, scale }: Pose): Float64Array {
  return Float64Array.from(new Matrix4().compose(position, quaternion, new Vector3(scale, scale, scale)).elements);
}

/** A pose whose frame was moved: the same place for points that had `offset` added. */
export function moved({ position, quaternion, scale }: Pose, offset: Vector3): Pose {
  const shift = offset.clone().multiplyScalar(scale).applyQuaternion(quaternion);
  return { position: shift.add(position), quaternion: quaternion.clone(), scale };
}

/**
 * The pose at a share of the way: turned evenly about one axis, grown by even ratios, and with the mesh's `centre` on a
 * straight line, so that what is far from its own origin does not swing about it.
 *
 * @param share 0 gives `from`, 1 gives `to`
 * @param centre in the mesh's frame
 */
export function between(from: Pose, to: Pose, share: number, centre: Vector3): Pose {
  const [a, b] = [moved(from, centre), moved(to, centre)];
  const middle = {
    position: a.position.lerp(b.position, share),
    quaternion: a.quaternion.slerp(b.quaternion, share),
    scale: a.scale * (b.scale / a.scale) ** share,
  };
  return moved(middle, centre.clone().negate());
}

/** Slow at both ends. */
export const eased = (share: number) => share * share * (3 - 2 * share);
