/** Similarity transforms as arguments. */
import { isRecord, plainNumbers } from "./values.js";

export type { Sim3 } from "./generated/types.js";

/**
 * A similarity as an argument: anything with a 4×4 `matrix` (column by column) or with `scale`, `rotation` (quaternion
 * x, y, z, w; 9 numbers row by row; or three rows of three) and `translation`; or the 16 numbers alone. Results of
 * `align` and `register` are accepted as they are.
 */
export type Sim3Like =
  | ArrayLike<number>
  | { readonly matrix: ArrayLike<number> }
  | {
      readonly scale: number;
      readonly rotation: ArrayLike<number> | readonly (readonly number[])[];
      readonly translation: ArrayLike<number>;
    };

/** The form of a similarity that the core reads. The core checks the numbers. */
export function coreSim3(transform: unknown): unknown {
  if (!isRecord(transform)) return plainNumbers(transform);
  const { matrix, scale, rotation, rotationMatrix, translation } = transform;
  // A result has all forms. Rows are exact.
  if (scale === undefined && matrix !== undefined) return { matrix: plainNumbers(matrix) };
  return { scale, rotation: plainNumbers(rotationMatrix ?? rotation), translation: plainNumbers(translation) };
}
