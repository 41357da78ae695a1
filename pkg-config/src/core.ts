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

/** What a module asks of the helpers of a task: other threads. */
export interface CoreHelpers {
  /** Asks for helpers. */
  ask(): void;
  send(helper: number, message: Float64Array): void;
  /** The next message that has arrived. Its first number is the helper; nothing else says that it has left. */
  receive(): Float64Array | undefined;
  /** Lets the next turn last until a message arrives. */
  wait(): void;
}

/** Runs tasks of a search in another thread. */
export interface Helper {
  /** Reads a message of the search. */
  receive(message: Float64Array): void;
  /**
   * Runs tasks for about this long; returns the message about them, whose first number is for the helper, or `undefined` if
   * there is nothing to do.
   */
  step(sliceMs: number): Float64Array<ArrayBuffer> | undefined;
  free(): void;
}

/** The functions of the core. They validate their arguments and throw errors with codes. */
export interface Core extends Glue {
  beginAlign(
    input: CoreInput,
    options: object,
    onProgress: CoreListener | undefined,
    helpers: CoreHelpers | undefined,
  ): Task<Results.Alignment>;
  beginHelp(input: CoreInput, options: object): Helper;
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
export const coreModule = /* @__PURE__ */ new WasmModule<Core>(
  "core",
  () => new URL("./wasm/core_bg.wasm", import.meta.url),
  () => glue as unknown as Core,
);
