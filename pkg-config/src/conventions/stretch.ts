/** Meshes in the proportions that an alignment found. */

import { isContent } from "../input/bytes.js";
import type { MeshArrays } from "../types/inputs.js";
import { failure } from "../values/error.js";
import { finiteNumbers, record, type Vector3 } from "../values/validation.js";
import { underNode } from "./glb.js";
import { mappedMesh, meshOf } from "./mesh.js";
import { eigenvectors } from "./principal-axes.js";
import { cofactors, column, dot, type Matrix3, norm, quaternionOf, scaled, transposed, turned } from "./rotation.js";

/** The part of `proportions` of a result that the functions read. */
export interface StretchLike {
  /** A symmetric matrix with positive eigenvalues, as three rows of three or nine numbers. */
  stretch: ArrayLike<number> | readonly (readonly number[])[];
}

/** Largest difference between entries of a symmetric matrix, relative to its largest one. */
const SYMMETRIC = 1e-6;

/**
 * A mesh in other proportions: its vertices times the stretch. It is placed by the transform in `proportions`, with which
 * all exports, boxes and sizes take it.
 *
 * A GLB gets two parent nodes above its scene: a scaling along the axes of the stretch, and the rotation to these. Its
 * materials, textures and animations are kept; nothing is decoded.
 *
 * @param mesh the aligned mesh: arrays, or the bytes of a GLB
 * @param proportions of a result of `align` with `proportions: "axes"` or `"full"`
 *
 * @example
 * const { proportions } = await aligner.align(input, { proportions: "full" });
 * const { sizeM } = orientedBoundingBox(stretchMesh(mesh, proportions), proportions);
 * @throws {@link Sim3AlignError} for an invalid mesh or GLB, and `INVALID_ARGUMENT` for a matrix that is not a stretch
 */
export function stretchMesh<M extends MeshArrays>(mesh: M, proportions: StretchLike): M;
export function stretchMesh(mesh: Uint8Array | ArrayBuffer, proportions: StretchLike): Uint8Array;
export function stretchMesh<M extends MeshArrays>(
  mesh: M | Uint8Array | ArrayBuffer,
  proportions: StretchLike,
): M | Uint8Array {
  if (isContent(mesh)) return stretchedGlb(mesh, stretchOf(proportions));
  meshOf("mesh", mesh);
  const matrix = stretchOf(proportions);
  // Normals turn with the inverse of the transpose.
  const normals = (vectors: Float32Array) => mapped(cofactors(matrix), vectors, true);
  return mappedMesh(mesh, (points) => mapped(matrix, points), normals);
}

function stretchedGlb(glb: Uint8Array | ArrayBuffer, matrix: Matrix3): Uint8Array {
  const axes = eigenvectors(matrix);
  const inAxes = underNode(glb, { name: "axes of the stretch", rotation: quaternionOf(transposed(axes)) });
  return underNode(inAxes, { name: "stretch", rotation: quaternionOf(axes), scale: lengthsAlong(matrix, axes) });
}

/** The eigenvalues of a symmetric matrix, by its eigenvectors. */
const lengthsAlong = (matrix: Matrix3, axes: Matrix3): Vector3 =>
  [0, 1, 2].map((k) => dot(column(axes, k as 0), turned(matrix, column(axes, k as 0)))) as Vector3;

function stretchOf(proportions: StretchLike): Matrix3 {
  const { stretch } = record("proportions", proportions, "{ stretch }, `proportions` of a result");
  const numbers = finiteNumbers("proportions.stretch", stretch, 9, "nine finite numbers, three rows of three");
  const matrix = numbers as unknown as Matrix3;
  const largest = Math.max(...numbers.map(Math.abs));
  const mirrored = transposed(matrix);
  const isSymmetric = matrix.every((x, i) => Math.abs(x - (mirrored[i] as number)) <= SYMMETRIC * largest);
  if (isSymmetric && lengthsAlong(matrix, eigenvectors(matrix)).every((length) => length > 0)) return matrix;
  const [found, expected] = [`[${numbers.join(", ")}]`, "a symmetric matrix with positive eigenvalues"];
  throw failure("INVALID_ARGUMENT", "proportions.stretch", found, expected, "Pass that of a result.");
}

/** Vectors times a matrix, one after the other; of length 1, if `isUnit`. */
function mapped(matrix: Matrix3, vectors: Float32Array, isUnit = false): Float32Array {
  const result = new Float32Array(vectors.length);
  for (let i = 0; i + 2 < vectors.length; i += 3) {
    const vector = turned(matrix, [vectors[i] as number, vectors[i + 1] as number, vectors[i + 2] as number]);
    result.set(isUnit ? scaled(vector, 1 / (norm(vector) || 1)) : vector, i);
  }
  return result;
}
