/** Similarities: what is taken for one, and how the results carry theirs. */
export type { Sim3Like } from "./argument-types.js";

import type * as Core from "./generated/types.js";
import { isRecord, plainNumbers } from "./values.js";

/** A similarity y = s·R·x + t in every form that callers ask for. */
export interface Sim3 extends Omit<Core.Sim3, "matrix"> {
  /** The 4×4 matrix, **column by column** (three.js `Matrix4.elements`, glTF `node.matrix`, WebGPU). */
  matrix: Float64Array;
}

/** The core's form of a similarity; it checks the numbers. */
export function coreSim3(transform: unknown): unknown {
  if (!isRecord(transform)) return plainNumbers(transform);
  const { matrix, scale, rotation, rotationMatrix, translation } = transform;
  // A result has all forms: of these, rows lose nothing.
  if (scale === undefined && matrix !== undefined) return { matrix: plainNumbers(matrix) };
  return { scale, rotation: plainNumbers(rotationMatrix ?? rotation), translation: plainNumbers(translation) };
}

/** A result with its matrix as a typed array. */
export function withTypedMatrix<T extends Core.Sim3>(result: T): Omit<T, "matrix"> & { matrix: Float64Array } {
  return { ...result, matrix: Float64Array.from(result.matrix) };
}
