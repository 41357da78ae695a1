/** Poses of a mesh (camera from mesh, OpenCV camera frame, metres) and the bounding box that they transform. */
import type { MeshArrays, Sim3 } from "sim3align";
import { orientedBoundingBox } from "sim3align/conventions/oriented-bounding-box";
import { applyToPoints, compose, toSim3 } from "sim3align/conventions/similarity";
import type { Vector3 } from "sim3align/values/validation";
import { once } from "./inputs.js";
import type { AnyAlignment } from "./object-model.js";

/** The origin of a pose. */
export type PoseSource = "start" | "aligned" | "alternative" | "refined" | "hand" | "tracked";

/** A pose and its origin. Immutable. */
export interface Pose {
  readonly transform: Sim3;
  readonly source: PoseSource;
  /** The index of the alternative, for poses with that source. */
  readonly alternative?: number;
  /** The last alignment, which has found this pose or one before it. */
  readonly alignment?: AnyAlignment | null;
}

/** Whether a pose is as an alignment has found it. */
export const isResult = (source: PoseSource | undefined): boolean => source === "aligned" || source === "refined";

/** A bounding box, in the mesh's frame and unit. */
export interface Bounds {
  readonly centre: Vector3;
  readonly sides: Vector3;
}

/** The smallest box around a mesh, in the mesh's frame and unit; its sides are named after the nearest axes. */
export interface TightBounds extends Bounds {
  /** Bit k of an index is the side on axis k. */
  readonly corners: readonly Vector3[];
}

/** The box at a pose: centre in the camera frame; width, height and depth along its own axes; metres. */
export interface PlacedBox {
  readonly centreM: Vector3;
  readonly sizeM: Vector3;
}

const identity = { scale: 1, rotation: [0, 0, 0, 1], translation: [0, 0, 0] };

/** Files are often tilted in their own axes, along which no person would measure. */
export const tightBoundsOf = once((mesh: MeshArrays): TightBounds => {
  const { centerM, sizeM, corners } = orientedBoundingBox(mesh, identity, { box: "minimal" });
  return { centre: centerM, sides: sizeM, corners };
});

/** The bounding box of a mesh's triangles along its axes. */
export function boundsOf({ positions, indices }: MeshArrays): Bounds {
  const low: Vector3 = [Number.POSITIVE_INFINITY, Number.POSITIVE_INFINITY, Number.POSITIVE_INFINITY];
  const high: Vector3 = [Number.NEGATIVE_INFINITY, Number.NEGATIVE_INFINITY, Number.NEGATIVE_INFINITY];
  const count = indices?.length ?? positions.length / 3;
  for (let i = 0; i < count; i++) {
    const vertex = 3 * (indices?.[i] ?? i);
    for (const k of [0, 1, 2] as const) {
      const x = positions[vertex + k] ?? 0;
      if (x < low[k]) low[k] = x;
      if (x > high[k]) high[k] = x;
    }
  }
  const combine = (f: (low: number, high: number) => number) => low.map((x, k) => f(x, high[k] ?? x)) as Vector3;
  return { centre: combine((a, b) => (a + b) / 2), sides: combine((a, b) => b - a) };
}

/** A bounding box at a pose. */
export function placed({ centre, sides }: Bounds, pose: Sim3): PlacedBox {
  const [x = 0, y = 0, z = 0] = applyToPoints(pose, Float64Array.from(centre));
  return { centreM: [x, y, z], sizeM: sides.map((side) => pose.scale * side) as Vector3 };
}

/** The quaternion of a rotation about an axis of the camera frame. */
export function rotationAbout(axis: Vector3, degrees: number): [number, number, number, number] {
  const half = (degrees * Math.PI) / 360;
  const [x, y, z] = axis;
  return [x * Math.sin(half), y * Math.sin(half), z * Math.sin(half), Math.cos(half)];
}

/** A change of a pose, about the object's centre. */
export interface Nudge {
  moveM?: Vector3;
  rotation?: [number, number, number, number];
  scale?: number;
}

/** The pose after a nudge. */
export function nudged(
  centreM: Vector3,
  from: Sim3,
  { moveM = [0, 0, 0], rotation = [0, 0, 0, 1], scale = 1 }: Nudge,
): Sim3 {
  const identity = [0, 0, 0, 1];
  const toOrigin = { scale: 1, rotation: identity, translation: centreM.map((x) => -x) };
  const back = { scale: 1, rotation: identity, translation: centreM.map((x, k) => x + (moveM[k] ?? 0)) };
  return compose(back, { scale, rotation, translation: [0, 0, 0] }, toOrigin, from);
}

/** The pose before any alignment: upright as in glTF, at the centre and with the size of the visible part. */
export function startPose(bounds: Bounds, visible: { centreM: Vector3; sizeM: number }): Sim3 {
  const scale = visible.sizeM / (Math.hypot(...bounds.sides) || 1);
  const upright = toSim3({ scale, rotation: [1, 0, 0, 0], translation: [0, 0, 0] });
  const { centreM } = placed(bounds, upright);
  const translation = visible.centreM.map((x, k) => x - (centreM[k] ?? 0)) as Vector3;
  return toSim3({ scale, rotation: [1, 0, 0, 0], translation });
}
