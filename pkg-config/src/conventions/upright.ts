/** Objects in upright frames of their own. */

import type { Sim3 } from "../generated/types.js";
import type { Sim3Like } from "../types/argument-types.js";
import type { MeshArrays } from "../types/inputs.js";
import { oneOf, optionsOf, record, type Vector3 } from "../values/validation.js";
import { underNode } from "./glb.js";
import { type Mesh, mappedMesh, meshOf } from "./mesh.js";
import { outermost, smallestBoxAxes, smallestRectangle } from "./minimal-box.js";
import { extent } from "./oriented-bounding-box.js";
import {
  column,
  cross,
  dot,
  fromColumns,
  type Matrix3,
  minus,
  plus,
  scaled,
  transposed,
  turned,
  unit,
} from "./rotation.js";
import { directionOf } from "./scene-frame.js";
import { applyToPoints, composed, inverted, type Similarity, sim3Of, similarityOf } from "./similarity.js";

/** Options of {@link uprightMesh}. */
export interface UprightOptions {
  /** The plane that the object stands on, as `support` of the result of `alignScene`: up is its normal. */
  support?: { normal: ArrayLike<number> } | null | undefined;
  /** The axis that points up: "y", the default, as in glTF; "z", as in simulators. */
  up?: "y" | "z" | undefined;
}

/** An object in its own upright frame. */
export type Upright<M> = {
  /** The mesh in this frame. Its box along the axes is tight, and stands on the origin. */
  mesh: M;
  /** OpenCV camera from the upright frame: every vertex stays where it was. */
  transform: Sim3;
  /** The frame: from the upright frame to that of the given mesh. */
  meshFromUpright: Sim3;
};

/** Decrease of the area by which a rectangle is turned: round outlines keep the heading of the mesh. */
const TIGHTER = 0.99;

/**
 * A mesh in an upright frame of its own, for objects that lie askew in their file, or with another axis up. Up is the
 * normal of the support or, without one, the axis of the smallest box that is nearest to the up of the image. The other
 * axes are those of the smallest rectangle around the object seen from above, named after the nearest axes of the mesh. The
 * origin is the centre of the bottom of the box. All exports and {@link orientedBoundingBox} take the mesh with its transform.
 *
 * @param mesh the aligned mesh, as arrays
 * @param transform OpenCV camera from mesh: a result of `align`
 * @param options with `glb`, the bytes of its file, `mesh` of the result is a GLB: with one more node above the scene, in
 * which materials, textures and animations are kept, and nothing is decoded
 *
 * @example
 * const straight = uprightMesh(mesh, result, { support });
 * const { sizeM: [width, height, depth] } = orientedBoundingBox(straight.mesh, straight.transform);
 * @throws {@link Sim3AlignError} for an invalid mesh, transform or plane, and `INVALID_OPTION`
 */
export function uprightMesh(
  mesh: MeshArrays,
  transform: Sim3Like,
  options: UprightOptions & { glb: Uint8Array | ArrayBuffer },
): Upright<Uint8Array>;
export function uprightMesh<M extends MeshArrays>(mesh: M, transform: Sim3Like, options?: UprightOptions): Upright<M>;
export function uprightMesh<M extends MeshArrays>(
  mesh: M,
  transform: Sim3Like,
  options: UprightOptions & { glb?: Uint8Array | ArrayBuffer } = {},
): Upright<M | Uint8Array> {
  const { glb, ...ofFrame } = optionsOf(options, ["support", "up", "glb"]);
  const frame = uprightFrame(mesh, transform, ofFrame);
  const back = sim3Of(inverted(frame));
  const placed = { transform: sim3Of(composed(similarityOf(transform), frame)), meshFromUpright: sim3Of(frame) };
  if (glb !== undefined) {
    const { rotation, translation } = back;
    return { mesh: underNode(glb, { name: "upright", rotation, translation }), ...placed };
  }
  const turn = { ...back, scale: 1, translation: [0, 0, 0] as Vector3, matrix: undefined };
  const straight = mappedMesh(
    mesh,
    (points) => applyToPoints(back, points),
    (normals) => applyToPoints(turn, normals),
  );
  return { mesh: straight, ...placed };
}

/** The upright frame of a mesh: from it to that of the mesh. */
function uprightFrame(mesh: MeshArrays, transform: Sim3Like, options: UprightOptions): Similarity {
  const { support = null, up = "y" } = options;
  const checked = meshOf("mesh", mesh);
  const toMesh = transposed(similarityOf(transform).rotation);
  const axis = oneOf("options.up", up, ["y", "z"]);
  const upward = upwardOf(checked, toMesh, support);
  // The front is z in files with y up, and −y in those with z up.
  const front: Vector3 = Math.abs(upward[2]) < 0.8 ? [0, 0, 1] : [0, -Math.sign(upward[2]), 0];
  const forward = unit(minus(front, scaled(upward, dot(upward, front))));
  const side = cross(upward, forward);
  const seen = outermost(checked).map((p) => [dot(side, p), dot(forward, p)] as const);
  const { cos, sin } = smallestRectangle(seen, TIGHTER);
  const tight = [plus(scaled(side, cos), scaled(forward, sin)), plus(scaled(side, -sin), scaled(forward, cos))];
  const back = nearest(tight.flatMap(bothWays), forward);
  const right = cross(upward, back);
  const rotation = axis === "y" ? fromColumns(right, upward, back) : fromColumns(right, scaled(back, -1), upward);
  const { low, high } = extent(checked, transposed(rotation));
  const bottom = low.map((x, k) => (k === (axis === "y" ? 1 : 2) ? x : (x + (high[k] ?? x)) / 2)) as Vector3;
  return { scale: 1, rotation, translation: turned(rotation, bottom) };
}

/** Up in the frame of a mesh: the normal of its support, or that axis of its smallest box. */
function upwardOf(mesh: Mesh, meshFromCamera: Matrix3, support: unknown): Vector3 {
  if (support !== null) {
    const { normal } = record("options.support", support, "{ normal, d }");
    return turned(meshFromCamera, directionOf("options.support.normal", normal).direction);
  }
  const axes = smallestBoxAxes(mesh);
  const ways = ([0, 1, 2] as const).flatMap((k) => bothWays(column(axes, k)));
  return nearest(ways, turned(meshFromCamera, [0, -1, 0]));
}

const bothWays = (v: Vector3): [Vector3, Vector3] => [v, scaled(v, -1)];

/** The direction among several that is nearest to another. */
const nearest = (directions: readonly Vector3[], to: Vector3): Vector3 =>
  directions.reduce((best, direction) => (dot(direction, to) > dot(best, to) ? direction : best));
