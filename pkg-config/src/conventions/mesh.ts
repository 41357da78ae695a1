/** Validation of meshes in arrays. */

import type { MeshArrays } from "../types/inputs.js";
import { checkAttached } from "../values/border.js";
import { describe, failure, invalidArgument } from "../values/error.js";
import { isBuffer, isRecord, isTypedArray } from "../values/kinds.js";
import { record, type Vector3, wrongKind } from "../values/validation.js";

/** A triangle mesh whose indices are in range. */
export interface Mesh {
  /** Interleaved x, y, z. */
  positions: Float32Array;
  /** Three per triangle; `null` if every three vertices form a triangle. */
  indices: Uint32Array | Uint16Array | null;
}

/** The arrays of a mesh, validated. */
export function meshOf(argument: string, mesh: unknown): Mesh {
  const content = isRecord(mesh) ? mesh.bytes : mesh;
  if (isTypedArray(content, "Uint8Array") || isBuffer(content)) {
    throw invalidArgument(
      argument,
      mesh,
      "{ positions, indices? }",
      "Pass the result of readMesh, or a GLB's bytes alone.",
    );
  }

  const { positions, indices } = record(argument, mesh, "{ positions, indices? }") as {
    [K in keyof MeshArrays]: unknown;
  };
  const [named, namedIndices] = [`${argument}.positions`, `${argument}.indices`];
  if (!isTypedArray<Float32Array>(positions, "Float32Array")) {
    throw wrongKind(named, positions, "a Float32Array, x, y, z per vertex", "Float32Array");
  }
  checkAttached(named, positions);
  const count = positions.length / 3;
  if (count === 0) throw failure("EMPTY_MESH", argument, "no vertex", "triangles", "Pass a mesh.");
  if (!Number.isInteger(count)) {
    const remedy = "Pass three numbers per vertex.";
    throw failure("WRONG_LENGTH", named, `${positions.length} numbers`, "x, y, z per vertex", remedy);
  }
  const wrong = positions.findIndex((number) => !Number.isFinite(number));
  if (wrong >= 0) {
    const found = `${positions[wrong]} in vertex ${Math.floor(wrong / 3)}`;
    throw failure("NON_FINITE", named, found, "finite numbers", "Remove vertices without a valid position.");
  }
  if (indices === undefined || indices === null) {
    if (count % 3 === 0) return { positions, indices: null };
    const remedy = "Pass indices, or three vertices per triangle.";
    throw failure("WRONG_LENGTH", named, `${count} vertices without indices`, "three per triangle", remedy);
  }
  if (!isTypedArray<Uint32Array | Uint16Array>(indices, "Uint32Array", "Uint16Array")) {
    throw wrongKind(namedIndices, indices, "a Uint32Array or a Uint16Array", "Uint32Array");
  }
  checkAttached(namedIndices, indices);
  if (indices.length === 0) throw failure("EMPTY_MESH", argument, "no triangle", "triangles", "Pass a mesh.");
  if (indices.length % 3 !== 0) {
    const remedy = "Split polygons into triangles.";
    throw failure("WRONG_LENGTH", namedIndices, `${indices.length} indices`, "three per triangle", remedy);
  }
  const outside = indices.find((index) => index >= count);
  if (outside !== undefined) {
    throw failure("INDEX_OUT_OF_RANGE", namedIndices, describe(outside), `indices below ${count}`, "Check the mesh.");
  }
  return { positions, indices };
}

/** The vertex at a corner of a triangle: corners are numbered through all triangles. */
export function vertexAt({ positions, indices }: Mesh, corner: number): Vector3 {
  const place = 3 * (indices === null ? corner : (indices[corner] ?? 0));
  return [positions[place] ?? 0, positions[place + 1] ?? 0, positions[place + 2] ?? 0];
}

/** Number of triangles. */
export const triangleCount = ({ positions, indices }: Mesh): number =>
  (indices ?? { length: positions.length / 3 }).length / 3;

/** The least and the largest coordinates, as accessors of positions need them. */
export function bounds(vertices: ArrayLike<number>): { min: number[]; max: number[] } {
  const [min, max] = [Array<number>(3).fill(Number.POSITIVE_INFINITY), Array<number>(3).fill(Number.NEGATIVE_INFINITY)];
  for (let i = 0; i < vertices.length; i++) {
    const x = vertices[i] as number;
    min[i % 3] = Math.min(min[i % 3] ?? x, x);
    max[i % 3] = Math.max(max[i % 3] ?? x, x);
  }
  return { min, max };
}

/** A mesh with its vertices, and the points and normals of its colours, mapped. */
export function mappedMesh<M extends MeshArrays>(
  mesh: M,
  points: (positions: Float32Array) => Float32Array,
  directions: (normals: Float32Array) => Float32Array,
): M {
  const { positions, samples } = mesh;
  if (samples === undefined || samples === null) return { ...mesh, positions: points(positions) };
  const mapped = { ...samples, positions: points(samples.positions), normals: directions(samples.normals) };
  return { ...mesh, positions: points(positions), samples: mapped };
}
