/** What the two WebAssembly modules export. */
import type * as Results from "./generated/types.js";
import type { CoreInput } from "./input/resolve.js";
import type { Defaults } from "./options.js";
import type { Glue } from "./wasm-module.js";

/** Points, x, y, z one after the other. */
export type Cloud = Float32Array | Float64Array;

/**
 * Called as a stage begins, and after each round of a search: with the best pose, 16 numbers, and its score, once there is
 * one. What it throws ends the call.
 */
export type CoreListener = (stage: Results.Stage, fraction: number, best?: Float64Array) => void;

/** The core's functions: they check what they are given, and throw coded errors. */
export interface Core extends Glue {
  align(input: CoreInput, options: object, onProgress: CoreListener | undefined): Results.Alignment;
  evaluate(input: CoreInput, transform: unknown, options: object): Results.Evaluation;
  register(source: Cloud, target: Cloud, options: object): Results.Registration;
  estimateSim3(source: Cloud, target: Cloud, correspondences: Uint32Array, options: object): Results.Registration;
  defaults(): Defaults;
  version(): string;
  beginShare(input: CoreInput, options: object): void;
  /** See {@link ShareStep}; without parts, ends the share. */
  stepShare(found: Float64Array | undefined, part: number, parts: number): Float64Array;
  /** Ends the share. */
  finishShare(onProgress: CoreListener | undefined): Results.Alignment;
}

/** The file readers' functions. */
export type Formats = typeof import("./wasm/formats.js");
