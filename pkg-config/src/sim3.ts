/** Similarity transforms as arguments. */
export type { Sim3Like } from "./argument-types.js";

import { isRecord, plainNumbers } from "./values.js";

export type { Sim3 } from "./generated/types.js";

/** The form of a similarity that the core reads. The core checks the numbers. */
export function coreSim3(transform: unknown): unknown {
  if (!isRecord(transform)) return plainNumbers(transform);
  const { matrix, scale, rotation, rotationMatrix, translation } = transform;
  // A result has all forms. Rows are exact.
  if (scale === undefined && matrix !== undefined) return { matrix: plainNumbers(matrix) };
  return { scale, rotation: plainNumbers(rotationMatrix ?? rotation), translation: plainNumbers(translation) };
}
