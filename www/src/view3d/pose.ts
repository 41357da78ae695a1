/** Similarities in terms of three.js, and their interpolation. */

import { toSim3 } from "sim3align/conventions/similarity";
import { Matrix4, Quaternion, Vector3 } from "./three.js";
import type { Matrix } from "./types.js";

/** A similarity. */
export interface Pose {
  position: Vector3;
  quaternion: Quaternion;
  scale: number;
}

/** Decomposes a matrix. Throws if the transform is not a similarity. */
export function poseOf(matrix: Matrix): Pose {
  const { scale, rotation, translation } = toSim3(matrix);
  return { position: new Vector3(...translation), quaternion: new Quaternion(...rotation), scale };
}

/** The matrix of a pose, column-major. */
export function matrixOf({ position, quaternion, scale }: Pose): Float64Array {
  return Float64Array.from(new Matrix4().compose(position, quaternion, new Vector3(scale, scale, scale)).elements);
}

/** The pose composed with a translation of the mesh: `pose(x + offset)`. */
export function shifted({ position, quaternion, scale }: Pose, offset: Vector3): Pose {
  const shift = offset.clone().multiplyScalar(scale).applyQuaternion(quaternion);
  return { position: shift.add(position), quaternion: quaternion.clone(), scale };
}

/**
 * Interpolates two poses: rotation by slerp, scale geometrically, and the centre of the mesh on a straight line, so that
 * a mesh far from its origin does not swing.
 *
 * @param share 0 gives `from`, 1 gives `to`
 * @param centre in the frame of the mesh
 */
export function between(from: Pose, to: Pose, share: number, centre: Vector3): Pose {
  const [a, b] = [shifted(from, centre), shifted(to, centre)];
  const middle = {
    position: a.position.lerp(b.position, share),
    quaternion: a.quaternion.slerp(b.quaternion, share),
    scale: a.scale * (b.scale / a.scale) ** share,
  };
  return shifted(middle, centre.clone().negate());
}

/** Smoothstep. */
export const eased = (share: number) => share * share * (3 - 2 * share);
