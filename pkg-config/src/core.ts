/** The interface of the core WebAssembly module. */
import type { Pinhole } from "./formats/pinhole.js";
import type * as Results from "./generated/types.js";
import type { CoreInput } from "./input/core-input.js";
import type { CoreMesh } from "./prepared-mesh.js";
import * as glue from "./wasm/core.js";
import { type Glue, WasmModule } from "./wasm-module.js";

/** Points as interleaved x, y, z. */
export type Cloud = Float32Array | Float64Array;

/**
 * Called when a stage begins and after each round of a search, with the best pose (16 numbers) and its score, if any.
 * Must not throw.
 */
export type CoreListener = (stage: Results.Stage, fraction: number, best?: Float64Array) => void;

/** A task of a module that runs in slices, so that the thread can do other work between them. */
export interface Task<T> {
  /** Runs for about this long; returns the result when finished. */
  step(sliceMs: number): T | undefined;
  free(): void;
}

/** The functions of the core. They validate their arguments and throw errors with codes. */
export interface Core extends Glue {
  beginAlign(input: CoreInput, options: object, onProgress: CoreListener | undefined): Task<Results.Alignment>;
  evaluate(input: CoreInput, transform: unknown, options: object): Results.Evaluation;
  /** The depth of a mesh at a pose, metres; 0 where no mesh is. */
  renderDepth(
    view: { mesh: CoreMesh; width: number; height: number; camera: Pinhole },
    transform: unknown,
  ): Float32Array;
  prepareMesh(mesh: CoreMesh): void;
  dropMesh(id: number): void;
  version(): string;
}

/** The core, shared by all aligners of this realm. */
export const coreModule = new WasmModule<Core>(
  "core",
  () => new URL("./wasm/core_bg.wasm", import.meta.url),
  () => glue as unknown as Core,
);
