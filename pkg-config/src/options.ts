/** Options of the calls. Ranges and defaults are in each field's documentation. */
import type * as Core from "./generated/types.js";

export type { Direction, ScaleOption, SymmetryAxis, SymmetryOption } from "./argument-types.js";

/** The progress of a call. */
export interface Progress {
  /** The stage that is running. */
  stage: Core.Stage;
  /** The share of the whole that is done, 0 to 1. It never falls. */
  fraction: number;
  /** The best pose so far. `precise` has one after each round of its search; the last one is the result. */
  best?: BestSoFar | undefined;
}

/** The best pose that a search has found so far. */
export interface BestSoFar {
  /** Camera from mesh, 16 numbers column by column, as a result's `matrix`: camera x right, y down, z forward; metres. */
  matrix: number[];
  /**
   * The search's objective. Higher is better. Early rounds render smaller images, so that scores of different rounds do not
   * compare; the last one is the result's `diagnostics.score`.
   */
  score: number;
}

/** Options that all calls have. */
export interface CallOptions {
  /**
   * Ends the call: it rejects with the signal's reason, by default an `AbortError`. A worker is terminated at once and
   * replaced. Without workers, the signal is checked before the call and whenever the call yields to other work.
   */
  signal?: AbortSignal | undefined;
  /**
   * Moves the arrays' buffers to the worker instead of copying them. They are detached here until the call ends; the
   * result's `input` (or the error's) then holds them again. They are lost with a worker that is terminated meanwhile.
   * Other arrays in the same buffers move with them. Without workers nothing moves. Default `false`.
   */
  transfer?: boolean | undefined;
}

/** Options of `align` that are about the call itself. */
interface AlignCallOptions extends CallOptions {
  /**
   * Called as each stage begins and after each round of the search, at most 20 times a second. An exception that it throws
   * ends the call, which rejects with it.
   */
  onProgress?: ((progress: Progress) => void) | undefined;
}

/**
 * Options of `Aligner.align` with the default preset, `"precise"`.
 * @example The mug is 9.5 cm tall, and the mesh's y axis is up:
 * ```ts
 * await aligner.align(input, { knownExtentM: 0.095, knownExtentAxis: "y" });
 * ```
 * @example The mesh is in metres:
 * ```ts
 * await aligner.align(input, { scale: 1 });
 * ```
 * @example An annotator has moved the object roughly into place:
 * ```ts
 * await aligner.align(input, { initial: { scale, rotation, translation }, search: "local" });
 * ```
 */
export interface AlignOptions extends Core.AlignOptions, AlignCallOptions {}

/** Options of `Aligner.align` with `preset: "paper"`. */
export interface PaperOptions extends Core.PaperOptions, AlignCallOptions {}

/** The options of each preset. */
export interface OptionsByPreset {
  precise: AlignOptions;
  paper: PaperOptions;
}

/** Options of `Aligner.align`: `preset` and `metrics` decide what the result has. */
export type OptionsOf<P extends Core.Preset, M extends boolean> = OptionsByPreset[P] & {
  preset?: P | undefined;
  metrics?: M | undefined;
};

/** Options of `Aligner.alignAll`: those of `align`, for every input. */
export type AlignAllOptions<P extends Core.Preset = "precise", M extends boolean = boolean> = {
  precise: Core.AlignOptions;
  paper: Core.PaperOptions;
}[P] &
  CallOptions & {
    preset?: P | undefined;
    metrics?: M | undefined;
    /** Whether results come in the order of the inputs instead of as they are ready. Default `false`. */
    ordered?: boolean | undefined;
    /** As that of `align`, with the input's index. */
    onProgress?: ((progress: Progress & { index: number }) => void) | undefined;
  };

/** Options of `Aligner.evaluate`. */
export interface EvaluateOptions extends Core.EvaluateOptions, CallOptions {}

/** Options of `Aligner.register`. */
export interface RegisterOptions extends Core.RegisterOptions, CallOptions {}

/** Options of `Aligner.estimateSim3`. */
export interface EstimateSim3Options extends Core.EstimateSim3Options, CallOptions {}

/** An option as the tables in `OPTIONS` describe it. */
export interface OptionRow {
  readonly name: string;
  readonly kind:
    | "integer"
    | "number"
    | "boolean"
    | "choice"
    | "scale"
    | "direction"
    | "symmetry"
    | "transform"
    | "guard";
  /** The smallest value, of numbers. */
  readonly min?: number;
  /** The largest value, of numbers. */
  readonly max?: number;
  /** A bound that numbers have to exceed. */
  readonly above?: number;
  /** All values of a choice. */
  readonly choices?: readonly string[];
  /** Whether `null` is a value. */
  readonly isNullable: boolean;
  readonly default: unknown;
  /** One line about it. */
  readonly summary: string;
}
