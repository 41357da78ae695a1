/** What the calls can be told to do otherwise. Units, ranges and defaults are in each field's documentation. */
import type * as Core from "./generated/types.js";
import type { Sim3Like } from "./sim3.js";

/** How far a call has come. */
export interface Progress {
  /** The stage that is under way. */
  stage: Core.Stage;
  /** Share of the whole that is done, 0 to 1; it never falls. */
  fraction: number;
  /** The best pose so far, once there is one: `precise`'s search has one after each round. The last is the result's. */
  best?: BestSoFar | undefined;
}

/** The best pose that a search has found so far. */
export interface BestSoFar {
  /** Camera from mesh, 16 numbers column by column, as a result's `matrix`: camera x right, y down, z forward; metres. */
  matrix: Float64Array;
  /**
   * The more the better. Early rounds draw smaller pictures, and scores of different rounds do not compare; the last one
   * is the result's `score`.
   */
  score: number;
}

/** What every call can be told. */
export interface CallOptions {
  /**
   * Ends the call: it rejects with the signal's reason, by default an `AbortError`. A worker is ended at once, and
   * replaced; without workers the signal is looked at before and between the stages, of which the thread is busy with
   * one at a time.
   */
  signal?: AbortSignal | undefined;
  /**
   * Moves the arrays' buffers to the worker instead of copying them: they are empty here until the call is over, when
   * the result's `input` holds them again (or the error's; they are lost with a worker that is ended while it has
   * them). Other arrays in the same buffers move with them. Without workers nothing moves. Default `false`.
   */
  transfer?: boolean | undefined;
}

/** A direction, of any length above 0. */
export type Direction = readonly [x: number, y: number, z: number];

/** A scale that is known, or bounds of it, in metres per mesh unit, above 0. */
export type ScaleBounds = number | readonly [min: number, max: number] | { readonly min: number; readonly max: number };

/**
 * Options of `Aligner.align`: most callers need none.
 * @example The mug is 9.5 cm tall, and the mesh's y axis is up:
 * ```ts
 * await aligner.align(input, { knownExtentM: 0.095, knownExtentAxis: "y" });
 * ```
 * @example The mesh is in metres already:
 * ```ts
 * await aligner.align(input, { scale: 1 });
 * ```
 * @example An annotator has moved the object roughly into place:
 * ```ts
 * await aligner.align(input, { initial: { scale, rotation, translation }, search: "local" });
 * ```
 */
export interface AlignOptions extends Partial<Core.AlignOptions>, CallOptions {
  /** Called as each stage begins and after each round of the search, at most 20 times a second. An exception that it throws ends the call, and rejects it. */
  onProgress?: ((progress: Progress) => void) | undefined;
}

/** Options of `Aligner.alignAll`: those of `align`, for every input. */
export interface AlignAllOptions extends Omit<AlignOptions, "onProgress"> {
  /** Whether results come in the order of the inputs, and not as they are ready. Default `false`. */
  ordered?: boolean | undefined;
  /** As that of `align`, with the input's place among the others. */
  onProgress?: ((progress: Progress & { index: number }) => void) | undefined;
}

/** An axis about which the object looks the same after a turn; all axes pass through its surface's centroid. */
export interface SymmetryAxis {
  /** In the mesh's frame. */
  axis: Direction;
  /** How many times the object looks the same in a full turn; without it, at any angle (a surface of revolution). */
  fold?: number | undefined;
}

/** The turns under which an object looks the same: found in the mesh, or declared. */
export type SymmetryOption = "none" | "auto" | "auto-revolution" | readonly SymmetryAxis[];

/** Options of `Aligner.evaluate`. */
export interface EvaluateOptions extends Partial<Core.EvaluateOptions>, CallOptions {
  /** The transform that is known to be right, for `errors`. */
  truth?: Sim3Like | undefined;
  /**
   * The turns under which the object looks the same: the rotation error is the smallest over them. `"auto"` finds the
   * half turns about the principal axes that the mesh itself shows, `"auto-revolution"` those axes about which it can be
   * turned by any angle, too. Default `"none"`.
   */
  symmetry?: SymmetryOption | undefined;
}

/**
 * What may happen to the scale, in target units per source unit: `"free"` is solved for, `"fixed"` is 1, a number is
 * known, [min, max] is solved for within bounds.
 */
export type ScaleOption = "free" | "fixed" | number | readonly [min: number, max: number];

/** Options of `Aligner.register`. */
export interface RegisterOptions extends Partial<Core.RegisterOptions>, CallOptions {
  /** What may happen to the scale. Default `"free"`. */
  scale?: ScaleOption | undefined;
}

/** Options of `Aligner.estimateSim3`. */
export interface EstimateOptions extends Partial<Core.EstimateOptions>, CallOptions {
  /** What may happen to the scale. Default `"free"`. */
  scale?: ScaleOption | undefined;
}

/** The values that options take where they are left out; a `scale` left out is `"free"`. */
export interface Defaults {
  align: Core.AlignOptions;
  evaluate: Core.EvaluateOptions;
  register: Core.RegisterOptions;
  estimateSim3: Core.EstimateOptions;
}
