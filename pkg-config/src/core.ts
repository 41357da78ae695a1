/** What the two WebAssembly modules export. */
import type * as Results from "./generated/types.js";
import type { CoreInput } from "./input/resolve.js";
import type { Defaults } from "./options.js";
import type { Glue } from "./wasm-module.js";

/** Points, x, y, z one after the other. */
export type Cloud = Float32Array | Float64Array;

/** Called as a stage begins; what it throws ends the call. */
export type CoreListener = (stage: Results.Stage, fraction: number) => void;

/** The core's functions: they check what they are given, and throw coded errors. */
export interface Core extends Glue {
  align(input: CoreInput, options: object, onProgress: CoreListener | undefined): Results.Alignment;
  evaluate(input: CoreInput, transform: unknown, options: object): Results.Evaluation;
  register(source: Cloud, target: Cloud, options: object): Results.Registration;
  estimateSim3(source: Cloud, target: Cloud, correspondences: Uint32Array, options: object): Results.Registration;
  defaults(): Defaults;
  version(): string;
  Share: new (input: CoreInput, options: object) => Share;
}

/** One's share of an alignment that several work on: see `src/align/split.rs`. */
export interface Share {
  /** How many tasks this round has; 0 when there is nothing left to do. */
  tasks(): number;
  isRefinement(): boolean;
  /** What comes of every `parts`-th task, the first of them being `part`. */
  run(part: number, parts: number): Float64Array;
  /** Takes what came of all tasks, in their order. */
  advance(found: Float64Array): void;
  hypothesis(): Float64Array;
  join(hypothesis: Float64Array): void;
  /** Ends the share. */
  finish(onProgress: CoreListener | undefined): Results.Alignment;
  free(): void;
}

/** The file readers' functions. */
export type Formats = typeof import("./wasm/formats.js");
