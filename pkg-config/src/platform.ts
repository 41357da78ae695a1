/**
 * What differs between browsers, Node and other hosts, by its shape: the declarations compile without TypeScript's DOM
 * library.
 */

/** A `Response` of `fetch`. */
export interface ResponseLike {
  readonly ok: boolean;
  readonly status: number;
  arrayBuffer(): Promise<ArrayBuffer>;
}

/** A compiled `WebAssembly.Module`, where TypeScript knows it. */
export type CompiledModule = typeof globalThis extends { WebAssembly: { Module: { prototype: infer Module } } }
  ? Module
  : object;

/** Where a WebAssembly module comes from: an address, a response, the bytes, or the compiled module. */
export type WasmSource = URL | string | ResponseLike | ArrayBuffer | ArrayBufferView | CompiledModule;

/** The source of a WebAssembly module, or a function that gets it when it is needed. */
export type LazySource = WasmSource | (() => WasmSource | Promise<WasmSource>);

/** A worker: a `Worker` of browsers, Deno and Bun, or one of Node's `worker_threads`. */
export interface WorkerLike {
  postMessage(message: unknown, transfer: ArrayBuffer[]): void;
  terminate(): unknown;
}

/** Makes a worker that runs this package's `worker.js`. */
export type CreateWorker = () => WorkerLike;
