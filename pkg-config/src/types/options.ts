/** Options of the calls. The documentation of each field states its range and default. */
import type * as Core from "../generated/types.js";
import type { SignalLike } from "./platform.js";

export type { Direction, ScaleOption, SymmetryAxis, SymmetryOption } from "./argument-types.js";

/** The progress of a call. */
export interface Progress {
  /** The current stage. */
  stage: Core.Stage;
  /** The fraction of the work that is done, 0 to 1. It never decreases. */
  fraction: number;
  /** The best pose so far. `precise` reports it after each round of its search; the last one is the result. */
  best?:
    | {
        /** Camera from mesh, 16 numbers, column-major, as `matrix` of a result. */
        matrix: number[];
        /**
         * The objective of the search. Higher is better. Scores of different rounds are not comparable, because early
         * rounds render smaller images. The last one is `diagnostics.score` of the result.
         */
        score: number;
      }
    | undefined;
}

/** Options of every call. */
export interface CallOptions {
  /**
   * Cancels the call, which rejects with the reason of the signal (by default an `AbortError`). A worker is terminated
   * at once and replaced. Without workers, the call checks the signal before it starts and each time it yields.
   */
  signal?: SignalLike | undefined;
  /**
   * Moves the buffers to the worker instead of copying them. The arrays are detached during the call; `input` of the
   * result, or of the error, returns them. They are lost if their worker is terminated. Other arrays on the same
   * buffers are detached as well. Has no effect without workers. Default `false`.
   */
  transfer?: boolean | undefined;
}

/** Options of calls to `align`. */
interface AlignCallOptions extends CallOptions {
  /**
   * Called when a stage begins and after each round of the search, at most 20 times a second. If it throws, the call
   * rejects with that exception. An async function is not awaited: if a promise that it returned rejects, the call
   * rejects with that reason; if the call has already settled, the rejection is ignored.
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
 * @example An annotator has placed the object approximately:
 * ```ts
 * await aligner.align(input, { initial: { scale, rotation, translation }, search: "local" });
 * ```
 */
export interface AlignOptions<M extends boolean = true> extends Core.AlignOptions, AlignCallOptions {
  /** Whether to compute `metrics`; `AlignOptions<false>` are options without. Default `true`. */
  metrics?: M | undefined;
}

/** Options of `Aligner.align` with `preset: "paper"`; `PaperOptions<false>` are options with `metrics: false`. */
export interface PaperOptions<M extends boolean = true> extends Core.PaperOptions, AlignCallOptions {
  /** Whether to compute `metrics`. Default `true`. */
  metrics?: M | undefined;
}

/** Options of `Aligner.align`: `preset` and `metrics` determine the type of the result. */
export type OptionsOf<P extends Core.Preset, M extends boolean> = {
  precise: AlignOptions<M>;
  paper: PaperOptions<M>;
}[P] & {
  preset?: P | undefined;
  metrics?: M | undefined;
};

/** Options of `Aligner.alignAll`: those of `align`, for every input. */
export type AlignAllOptions<P extends Core.Preset = "precise", M extends boolean = true> = {
  precise: Omit<AlignOptions<M>, "onProgress">;
  paper: Omit<PaperOptions<M>, "onProgress">;
}[P] & {
  preset?: P | undefined;
  metrics?: M | undefined;
  /** Yields results in the order of the inputs instead of the order of completion. Default `false`. */
  ordered?: boolean | undefined;
  /** Like `onProgress` of `align`, with the index of the input. */
  onProgress?: ((progress: Progress & { index: number }) => void) | undefined;
};

/** Options of `Aligner.alignViews`. */
export interface ViewsOptions extends Core.ViewsOptions, AlignCallOptions {}

/** Options of `Aligner.track`. */
export interface TrackOptions extends Core.TrackOptions, Pick<CallOptions, "signal"> {}

/** Options of `Aligner.evaluate`. */
export interface EvaluateOptions extends Core.EvaluateOptions, CallOptions {}

/** Options of `Aligner.register`. */
export interface RegisterOptions extends Core.RegisterOptions, CallOptions {}

/** Options of `Aligner.estimateSim3`. */
export interface EstimateSim3Options extends Core.EstimateSim3Options, CallOptions {}

/** The description of an option in the tables of `OPTIONS`. */
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
  /** The minimum of a number. */
  readonly min?: number;
  /** The maximum of a number. */
  readonly max?: number;
  /** An exclusive lower bound of a number. */
  readonly above?: number;
  /** The values of a choice. */
  readonly choices?: readonly string[];
  /** Whether `null` is allowed. */
  readonly isNullable: boolean;
  readonly default: unknown;
  /** A one-line description. */
  readonly summary: string;
}
