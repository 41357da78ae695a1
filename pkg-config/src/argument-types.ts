/** The types of arguments that options share. They import nothing, so that the generated declarations can use them. */

/** A direction, of any length above 0. */
export type Direction = readonly [x: number, y: number, z: number];

/** A scale in target units per source unit: `"free"` to have it estimated, its value, or bounds. */
export type ScaleOption = "free" | number | readonly [min: number, max: number];

/** A rotational symmetry about an axis through the centroid of the object's surface. */
export interface SymmetryAxis {
  /** The axis in the mesh's frame. */
  axis: Direction;
  /** How many times the object looks the same in a full turn. Leave it out for a surface of revolution. */
  fold?: number | undefined;
}

/** An object's symmetry: none, detected in the mesh, or declared. */
export type SymmetryOption = "none" | "auto" | "auto-revolution" | readonly SymmetryAxis[];

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
