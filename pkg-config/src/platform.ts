/**
 * Structural types of objects that differ between browsers, Node and other hosts, so that the declarations compile
 * without TypeScript's DOM library.
 */

/** A `Response` of `fetch`. */
export interface ResponseLike {
  readonly ok: boolean;
  readonly status: number;
  arrayBuffer(): Promise<ArrayBuffer>;
}

/** A compiled `WebAssembly.Module`, if its type is declared. */
export type CompiledModule = typeof globalThis extends { WebAssembly: { Module: { prototype: infer Module } } }
  ? Module
  : object;

/** The source of a WebAssembly module: a URL, a response, the bytes, or the compiled module. */
export type WasmSource = URL | string | ResponseLike | ArrayBuffer | ArrayBufferView | CompiledModule;

/** The source of a WebAssembly module, or a function that returns one on demand. */
export type LazySource = WasmSource | (() => WasmSource | Promise<WasmSource>);

/** A worker: a `Worker` of browsers, Deno and Bun, or one of Node's `worker_threads`. */
export interface WorkerLike {
  postMessage(message: unknown, transfer: ArrayBuffer[]): void;
  terminate(): unknown;
}

/** Creates a worker that runs `worker.js` of this package. */
export type CreateWorker = () => WorkerLike;
