/** Similarity transforms as arguments. */
export type { Sim3Like } from "../types/argument-types.js";

import { isKind, isRecord } from "../values/kinds.js";

export type { Sim3 } from "../generated/types.js";

/** Converts a similarity to the form that the core reads. The core checks the numbers. */
export function coreSim3(transform: unknown): unknown {
  if (!isRecord(transform)) return plainNumbers(transform);
  const { matrix, scale, rotation, rotationMatrix, translation } = transform;
  // A result has all forms; the matrix rows are exact.
  if (scale === undefined && matrix !== undefined) return { matrix: plainNumbers(matrix) };
  return { scale, rotation: plainNumbers(rotationMatrix ?? rotation), translation: plainNumbers(translation) };
}

/** Converts any array to a plain one. Other values are unchanged, for the core to reject. */
function plainNumbers(value: unknown): unknown {
  return ArrayBuffer.isView(value) && !isKind(value, "DataView") ? Array.from(value as unknown as number[]) : value;
}
