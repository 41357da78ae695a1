/**
 * Structural types of objects that differ between browsers, Node and other hosts, so that the declarations compile
 * without TypeScript's DOM library.
 */

/** A `Blob` or a `File`. */
export interface BlobLike {
  readonly size: number;
  readonly type: string;
  /** Its bytes. */
  arrayBuffer(): Promise<ArrayBuffer>;
}

/** A `URL`. */
export interface UrlLike {
  readonly href: string;
}

/** The signal of an `AbortController`. */
export interface SignalLike {
  readonly aborted: boolean;
  readonly reason: unknown;
  /** Adds a listener of the abort. */
  addEventListener(type: "abort", listener: () => void, options?: { once?: boolean }): void;
  /** Removes it. */
  removeEventListener(type: "abort", listener: () => void): void;
}

/**
 * The source of a WebAssembly module: a URL (text or `URL`), a `Response`, the bytes, or a compiled `WebAssembly.Module`. No
 * library but the DOM's declares the type of the last one.
 */
export type WasmSource = string | object;

/** The source of a WebAssembly module, or a function that returns one on demand. */
export type LazySource = WasmSource | (() => WasmSource | Promise<WasmSource>);

/** What all workers have. */
interface AnyWorker {
  postMessage(message: unknown, transfer: ArrayBuffer[]): void;
  terminate(): unknown;
}

/** An event of a `Worker`: a message has `data`, an error `message`. */
export interface WorkerEvent {
  readonly data?: unknown;
  readonly message?: string;
  preventDefault?(): void;
}

/** A `Worker` of browsers, Deno and Bun. */
export interface WebWorkerLike extends AnyWorker {
  addEventListener(type: "message" | "error" | "messageerror", listener: (event: WorkerEvent) => void): unknown;
}

/** A worker of Node's `worker_threads`. */
export interface NodeWorkerLike extends AnyWorker {
  on(event: "message" | "error" | "messageerror" | "exit", listener: (value: unknown) => void): unknown;
  ref?(): unknown;
  unref?(): unknown;
}

/** A worker: a `Worker` of browsers, Deno and Bun, or one of Node's `worker_threads`. */
export type WorkerLike = WebWorkerLike | NodeWorkerLike;

/** Creates a worker that runs `worker.js` of this package. */
export type CreateWorker = () => WorkerLike;
