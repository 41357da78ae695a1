/** The types of arguments that options share. They import nothing, so that the generated declarations can use them. */

/** A direction, of any length above 0. */
export type Direction = readonly [x: number, y: number, z: number];

/** A scale that is known, or bounds of it, in metres per mesh unit, above 0. */
export type ScaleBounds = number | readonly [min: number, max: number] | { readonly min: number; readonly max: number };

/** An axis about which the object looks the same after a turn; all axes pass through its surface's centroid. */
export interface SymmetryAxis {
  /** In the mesh's frame. */
  axis: Direction;
  /** How many times the object looks the same in a full turn; without it, at any angle (a surface of revolution). */
  fold?: number | undefined;
}

/** The turns under which an object looks the same: found in the mesh, or declared. */
export type SymmetryOption = "none" | "auto" | "auto-revolution" | readonly SymmetryAxis[];

/**
 * A similarity as an argument: anything with a 4×4 `matrix` (column by column) or with `scale`, `rotation` (quaternion
 * x, y, z, w; 9 numbers row by row; or three rows of three) and `translation`; or the 16 numbers alone. So a result
 * of `align` is one.
 */
export type Sim3Like =
  | ArrayLike<number>
  | { readonly matrix: ArrayLike<number> }
  | {
      readonly scale: number;
      readonly rotation: ArrayLike<number> | readonly (readonly number[])[];
      readonly translation: ArrayLike<number>;
    };
