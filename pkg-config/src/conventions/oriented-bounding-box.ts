/** Bounding boxes of aligned objects, and thereby their dimensions. */

import type { Sim3, Sim3Like } from "../input/sim3.js";
import type { MeshArrays } from "../types/inputs.js";
import { oneOf, optionsOf, type Vector3 } from "../values/validation.js";
import { type Mesh, meshOf, triangleCount, vertexAt } from "./mesh.js";
import { smallestBoxAxes } from "./minimal-box.js";
import { identity, type Matrix3, product, quaternionOf, transposed, turned } from "./rotation.js";
import { moved, similarityOf } from "./similarity.js";

/** An oriented box around an object, in the OpenCV camera frame. */
export type OrientedBoundingBox = {
  /** Side lengths along the box's x, y and z, in metres; for a mesh with y up: width, height, depth. */
  sizeM: Sim3["translation"];
  /** The centre, in metres. */
  centerM: Sim3["translation"];
  /** Rotation from box to camera, as a quaternion x, y, z, w. */
  rotation: Sim3["rotation"];
  /** The corners, in metres: from the smallest to the largest x, y, z of the box, with x changing fastest. */
  corners: [
    Sim3["translation"],
    Sim3["translation"],
    Sim3["translation"],
    Sim3["translation"],
    Sim3["translation"],
    Sim3["translation"],
    Sim3["translation"],
    Sim3["translation"],
  ];
};

/**
 * The metric size of an aligned object, and the box around it.
 *
 * With `box: "minimal"`, the orientation of the box is optimised: starting from the axes of the mesh and from the
 * principal axes of its surface, each pair of axes is rotated to the smallest rectangle around the projected vertices
 * until the volume no longer decreases. The result is optimal in each plane, but not guaranteed to be the smallest box
 * in space. Vertices that belong to no triangle are ignored.
 *
 * @param mesh the aligned mesh
 * @param transform OpenCV camera from mesh: a result of `align`
 * @param options `box`: "axes", the default, uses the axes of the mesh; "minimal" uses the smallest box found, whose axes
 * are named after the nearest axes of the mesh
 *
 * @example
 * const { sizeM: [width, height, depth] } = orientedBoundingBox(mesh, result);
 * @throws {@link Sim3AlignError} for an invalid mesh or transform, and `INVALID_OPTION`
 */
export function orientedBoundingBox(
  mesh: MeshArrays,
  transform: Sim3Like,
  options: { box?: "axes" | "minimal" | undefined } = {},
): OrientedBoundingBox {
  const { box = "axes" } = optionsOf(options, ["box"]);
  const checked = meshOf("mesh", mesh);
  const similarity = similarityOf(transform);
  const isMinimal = oneOf("options.box", box, ["axes", "minimal"]) === "minimal";
  const meshFromBox = isMinimal ? smallestBoxAxes(checked) : identity;
  const { low, high } = extent(checked, transposed(meshFromBox));
  const corner = (i: number): Vector3 => {
    const inBox: Vector3 = [(i & 1 ? high : low)[0], (i & 2 ? high : low)[1], (i & 4 ? high : low)[2]];
    return moved(similarity, turned(meshFromBox, inBox));
  };
  const middle = low.map((x, k) => (x + (high[k] ?? x)) / 2) as Vector3;
  return {
    sizeM: low.map((x, k) => similarity.scale * ((high[k] ?? x) - x)) as Vector3,
    centerM: moved(similarity, turned(meshFromBox, middle)),
    rotation: quaternionOf(product(similarity.rotation, meshFromBox)),
    corners: [corner(0), corner(1), corner(2), corner(3), corner(4), corner(5), corner(6), corner(7)],
  };
}

/** The bounds of the vertices along the rows of a matrix. */
export function extent(mesh: Mesh, rows: Matrix3): { low: Vector3; high: Vector3 } {
  const low: Vector3 = [Number.POSITIVE_INFINITY, Number.POSITIVE_INFINITY, Number.POSITIVE_INFINITY];
  const high: Vector3 = [Number.NEGATIVE_INFINITY, Number.NEGATIVE_INFINITY, Number.NEGATIVE_INFINITY];
  for (let i = 0; i < 3 * triangleCount(mesh); i++) {
    const point = turned(rows, vertexAt(mesh, i));
    for (const k of [0, 1, 2] as const) {
      if (point[k] < low[k]) low[k] = point[k];
      if (point[k] > high[k]) high[k] = point[k];
    }
  }
  return { low, high };
}
