/** The frame of a scene: the ground, and the directions over it. */
import { finite, positive, record, type Vector3, vector3 } from "../values/values.js";
import { cross, dot } from "./rotation.js";

export const scaled = (a: Vector3, s: number): Vector3 => [a[0] * s, a[1] * s, a[2] * s];
export const minus = (a: Vector3, b: Vector3): Vector3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const unit = (a: Vector3): Vector3 => scaled(a, 1 / Math.sqrt(dot(a, a)));

/** The mean of points; the origin of none. */
export function meanOf(points: readonly Vector3[]): Vector3 {
  const sum = points.reduce<Vector3>((a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]], [0, 0, 0]);
  return scaled(sum, 1 / Math.max(points.length, 1));
}

/** Directions and the origin of a scene's frame, in the OpenCV camera frame, metres. */
export interface GroundFrame {
  /** To the right of the camera, as far as the ground allows. */
  right: Vector3;
  up: Vector3;
  /** Towards the camera. */
  back: Vector3;
  /** The foot of the mean of the centres on the ground. */
  origin: Vector3;
}

/**
 * The frame of a scene on a plane. Without one, up is that of the image, and the origin is the camera.
 * @throws {@link Sim3AlignError} for an invalid plane
 */
export function groundFrame(
  support: { normal: ArrayLike<number>; d: number } | null,
  centers: readonly Vector3[],
): GroundFrame {
  if (support === null) return { right: [1, 0, 0], up: [0, -1, 0], back: [0, 0, -1], origin: [0, 0, 0] };
  record("options.support", support, "{ normal, d }");
  const normal = vector3("options.support.normal", support.normal);
  const length = positive("the length of options.support.normal", Math.sqrt(dot(normal, normal)));
  const d = finite("options.support.d", support.d) / length;
  const up = scaled(normal, 1 / length);
  // The camera's right stays right, unless it looks along the ground sideways.
  const along: Vector3 = Math.abs(up[0]) < 0.9 ? [1, 0, 0] : [0, 0, -1];
  const right = unit(minus(along, scaled(up, dot(along, up))));
  const center = meanOf(centers);
  return { right, up, back: cross(right, up), origin: minus(center, scaled(up, dot(up, center) + d)) };
}
