/** Cuboids of CVAT's 3D tasks. */
import { finiteNumbers, positive, record, type Vector3, vector3 } from "../values/validation.js";
import type { Cuboid } from "./cuboid.js";
import { type Matrix3, quaternionOf, rotationFromQuaternion } from "./rotation.js";

/** What CVAT keeps of a cuboid, in the frame of the point cloud of the task. */
export type CvatCuboid = Pick<Cuboid, "center" | "size" | "quaternion">;

/** CVAT has as many numbers for each cuboid as for the eight corners of one in an image. */
const POINTS = 16;

/**
 * Converts a cuboid to the `points` of a shape of CVAT (`type: "cuboid"`, 3D tasks): centre, rotations about x, y and z in
 * radians (R = Rx·Ry·Rz), size, and seven zeros. The cuboid must be in the frame of the task's point cloud; CVAT draws z up.
 *
 * @param cuboid from {@link toCuboid}
 *
 * @example
 * const shape = { type: "cuboid", frame: 0, label_id: 1, points: toCvatCuboid(toCuboid(orientedBoundingBox(mesh, result))) };
 * @throws {@link Sim3AlignError} for an invalid cuboid
 */
export function toCvatCuboid(cuboid: CvatCuboid): number[] {
  const { center, size, quaternion } = record("cuboid", cuboid, "{ center, size, quaternion }");
  const sides = vector3("cuboid.size", size);
  for (const side of sides) positive("cuboid.size", side);
  const m = rotationFromQuaternion("cuboid.quaternion", quaternion);
  const level = Math.hypot(m[0], m[1]);
  // Where y is a quarter turn, x and z turn about the same axis: z is 0.
  const [x, z] = level > 1e-9 ? [Math.atan2(-m[5], m[8]), Math.atan2(-m[1], m[0])] : [Math.atan2(m[7], m[4]), 0];
  const numbers = [...vector3("cuboid.center", center), x, Math.atan2(m[2], level), z, ...sides];
  // Without negative zeros.
  return [...numbers, ...new Array<number>(POINTS - numbers.length).fill(0)].map((number) => number + 0);
}

/**
 * Converts the `points` of a cuboid of CVAT's 3D tasks.
 *
 * @param points 16 numbers
 * @returns the cuboid, in the frame of the point cloud of the task
 *
 * @example
 * const { center, size, quaternion } = fromCvatCuboid(annotations.shapes[0].points);
 * @throws {@link Sim3AlignError} `WRONG_LENGTH`, `NON_FINITE` or `INVALID_ARGUMENT` for other numbers
 */
export function fromCvatCuboid(points: ArrayLike<number>): CvatCuboid {
  const given = finiteNumbers("points", points, POINTS, "the 16 numbers of a cuboid of CVAT");
  const [x, y, z] = given.slice(3, 6) as Vector3;
  const size = given.slice(6, 9) as Vector3;
  for (const side of size) positive("points", side);
  const [a, b] = [Math.cos(x), Math.sin(x)];
  const [c, d] = [Math.cos(y), Math.sin(y)];
  const [e, f] = [Math.cos(z), Math.sin(z)];
  const rotation: Matrix3 = [
    ...([c * e, -c * f, d] as const),
    ...([a * f + b * d * e, a * e - b * d * f, -b * c] as const),
    ...([b * f - a * d * e, b * e + a * d * f, a * c] as const),
  ];
  return { center: given.slice(0, 3) as Vector3, size, quaternion: quaternionOf(rotation) };
}
