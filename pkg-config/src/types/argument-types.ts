/** Argument types of options. This file imports nothing, so that the generated declarations can import it. */

/** A direction, of any length above 0. */
export type Direction = readonly [x: number, y: number, z: number];

/** A scale in target units per source unit: `"free"` to estimate it, a known value, or bounds. */
export type ScaleOption = "free" | number | readonly [min: number, max: number];

/** A rotational symmetry about an axis through the centroid of the object's surface. */
export interface SymmetryAxis {
  /** The axis in the mesh's frame. */
  axis: Direction;
  /**
   * Order of the symmetry: the number of equivalent positions in a full rotation. Omit it for a surface of revolution.
   */
  fold?: number | undefined;
}

/** The symmetry of an object: none, found on its mesh, or declared. */
export type SymmetryOption = "none" | "auto" | readonly SymmetryAxis[];

/**
 * A similarity as an argument: an object with a 4×4 `matrix` (column-major) or with `scale`, `rotation` (quaternion x,
 * y, z, w; 9 numbers, row-major; or three rows of three) and `translation`; or a bare array of 16 numbers. Results of
 * `align` and `register` can be passed directly.
 */
export type Sim3Like =
  | ArrayLike<number>
  | { readonly matrix: ArrayLike<number> }
  | {
      readonly scale: number;
      readonly rotation: ArrayLike<number> | readonly (readonly number[])[];
      readonly translation: ArrayLike<number>;
    };
