/**
 * Poses of meshes whose coordinates are far from zero, such as those of a map. The core aligns such a mesh relative to an
 * origin o in it; callers pass and receive poses of the mesh in its file: s·R·(p − o) + t = s·R·p + (t − s·R·o).
 */
import { type Matrix3, rotationOfUnit, turned } from "../conventions/rotation.js";
import { isRecord } from "../values/kinds.js";
import type { Quaternion, Vector3 } from "../values/validation.js";

/** x, y, z of the origin in the mesh file. */
export type Origin = readonly number[];

/** A result in which all poses are those of the mesh in its file. */
export function fromOrigin<T>(value: T, origin: Origin | undefined): T {
  return origin === undefined ? value : (relocated(value, origin, -1) as T);
}

/** An argument of the core in which all poses are those of the mesh relative to its origin. */
export function toOrigin<T>(value: T, origin: Origin | undefined): T {
  return origin === undefined ? value : (relocated(value, origin, 1) as T);
}

function relocated(value: unknown, origin: Origin, sign: 1 | -1): unknown {
  if (Array.isArray(value)) {
    return isMatrix(value) ? movedMatrix(value, product(value, origin), sign) : each(value, origin, sign);
  }
  if (!isRecord(value)) return value;
  const { scale, rotation, rotationMatrix, translation, matrix, stretch } = value;
  const moved = Object.fromEntries(Object.entries(value).map(([name, part]) => [name, relocated(part, origin, sign)]));
  const columns = isMatrix(matrix) ? matrix : columnsOf(scale, rotationMatrix ?? rotation);
  if (columns === undefined || !Array.isArray(translation)) return moved;
  // In other proportions, s·R·S·(p − o) + t.
  const stretched = Array.isArray(stretch) ? turned(stretch.flat() as unknown as Matrix3, origin as Vector3) : origin;
  const offset = product(columns, stretched);
  return {
    ...moved,
    ...(isMatrix(matrix) ? { matrix: movedMatrix(matrix, offset, sign) } : {}),
    translation: translation.map((t, axis) => t + sign * (offset[axis] as number)),
  };
}

const each = (values: readonly unknown[], origin: Origin, sign: 1 | -1) =>
  typeof values[0] === "object" ? values.map((value) => relocated(value, origin, sign)) : values;

const isMatrix = (value: unknown): value is number[] =>
  Array.isArray(value) && value.length === 16 && value.every((number) => typeof number === "number");

/** The rotation and the scale of 16 numbers, column by column, times a vector. */
const product = (matrix: readonly number[], [x = 0, y = 0, z = 0]: Origin) =>
  [0, 1, 2].map((row) => {
    const [a = 0, b = 0, c = 0] = [matrix[row], matrix[row + 4], matrix[row + 8]];
    return a * x + b * y + c * z;
  });

function movedMatrix(matrix: readonly number[], offset: readonly number[], sign: 1 | -1): number[] {
  return matrix.map((number, i) => number + (i >= 12 && i < 15 ? sign * (offset[i - 12] as number) : 0));
}

/** s·R as 16 numbers, column by column; R as a quaternion x, y, z, w or as rows. */
function columnsOf(scale: unknown, rotation: unknown): number[] | undefined {
  if (typeof scale !== "number" || !Array.isArray(rotation)) return undefined;
  const flat = rotation.flat() as number[];
  const length = Math.hypot(...flat);
  const rows = flat.length === 4 ? rotationOfUnit(flat.map((q) => q / length) as Quaternion) : flat;
  if (rows.length !== 9) return undefined;
  return Array.from({ length: 16 }, (_, i) => (i % 4 < 3 && i < 12 ? scale * Number(rows[3 * (i % 4) + (i >> 2)]) : 0));
}
