/** The options of `createAligner`, and the options of calls that the core does not check. */

import { onAbort } from "../concurrency/on-abort.js";
import type { LazyModules, WasmModules } from "../modules/modules.js";
import type { CreateWorker, SignalLike, UrlLike, WorkerLike } from "../types/platform.js";
import { failure, invalidArgument } from "../values/error.js";
import { isKind } from "../values/kinds.js";
import { checkNames, record, withoutUndefined } from "../values/validation.js";

/** Options of `createAligner`. */
export interface AlignerOptions {
  /**
   * Where the WebAssembly modules are: the URL of their folder, or the source of each. Default: `wasm/` next to this
   * script. The core is loaded at once, the others when they are first needed.
   */
  wasm?: string | UrlLike | WasmModules | undefined;
  /**
   * The number of workers: 0 (the default) runs calls on the calling thread; `"auto"` is one less than the number of
   * cores, 1 to 8. Workers run this package's `worker.js` as module `Worker`s, or as `node:worker_threads`. They need
   * neither shared memory nor special headers. Idle workers do not keep a Node process alive.
   */
  workers?: number | "auto" | undefined;
  /** Creates a worker that runs `worker.js` of this package. Needed only if that file is not next to this script. */
  createWorker?: (() => WorkerLike) | undefined;
  /**
   * Longest time that a new worker may take until it answers, milliseconds; 60 000 by default. A call whose workers do not
   * answer rejects with `WORKER_FAILED`: their script is another one, or was never loaded.
   */
  workerStartMs?: number | undefined;
}

/**
 * The assets that `sim3align/inline` bundles.
 * @internal
 */
export interface BundledAssets {
  wasm?: LazyModules;
  workerScript?: string;
}

/** Options without undefined properties. The core checks names and values. */
export function checkedOptions<T extends object>(options: T | undefined) {
  const own = options === undefined ? ({} as T) : (record("options", options, "an object with options") as T);
  const misplaced = Object.keys(own).find((name) => alignerOptions.includes(name));
  if (misplaced === undefined) return withoutUndefined(own);
  const found = "an option of createAligner";
  const remedy = `Pass it to createAligner({ ${misplaced} }).`;
  throw failure("UNKNOWN_OPTION", `options.${misplaced}`, found, "options of this call", remedy);
}

const alignerOptions: readonly string[] = [
  "wasm",
  "workers",
  "createWorker",
  "workerStartMs",
] satisfies (keyof AlignerOptions)[];

/** The options of `createAligner`. Each is checked where it is used. */
export function checkedAlignerOptions(options: AlignerOptions): AlignerOptions {
  const own = record("options", options, "an object with options");
  const remedy = "Check the spelling. Options of a call, such as `quality`, belong to the call.";
  checkNames("", own, alignerOptions, remedy, "UNKNOWN_OPTION");
  return own;
}

/** The function of the caller that creates workers. */
export function checkedFactory(createWorker: unknown): CreateWorker | undefined {
  if (createWorker === undefined || typeof createWorker === "function") return createWorker as CreateWorker | undefined;
  throw invalidArgument("createWorker", createWorker, "a function that returns a worker", "Pass () => new Worker(…).");
}

/** The time that a worker may take until it answers, milliseconds. */
export function checkedStartMs(startMs: unknown = 60_000): number {
  // The longest time that timers know.
  if (typeof startMs === "number" && startMs > 0 && startMs < 2 ** 31) return startMs;
  throw invalidArgument("workerStartMs", startMs, "milliseconds above 0", "Omit it for 60 seconds.");
}

/** An option that is true or false. */
export function checkedFlag(name: string, value: unknown): boolean {
  if (typeof value === "boolean") return value;
  throw invalidArgument(`options.${name}`, value, "true or false", "Omit it to use the default.");
}

/** An abort signal of any realm. */
export function checkedSignal(signal: unknown): SignalLike | undefined {
  if (signal === undefined || signal === null) return undefined;
  try {
    if (isKind<SignalLike>(signal, "AbortSignal") && typeof signal.aborted === "boolean") {
      // A proxy of a signal throws.
      onAbort(signal, () => {})();
      return signal;
    }
  } catch {}
  throw invalidArgument("options.signal", signal, "an AbortSignal", "Pass the signal of an AbortController.");
}

/** Upper limit of the number of workers. */
export const MAX_WORKERS = 64;

/** Upper limit of "auto", because each worker holds a copy of its input. */
const MAX_AUTO = 8;

/** The number of workers that "auto" stands for on a machine with so many cores. */
export const autoWorkers = (cores: number): number => Math.min(Math.max(cores - 1, 1), MAX_AUTO);

/** The number of workers. */
export function checkedWorkers(workers: unknown = 0): number | "auto" {
  const isCount = Number.isInteger(workers) && (workers as number) >= 0 && (workers as number) <= MAX_WORKERS;
  if (workers === "auto" || isCount) return workers as number | "auto";
  const remedy = "Omit it to run on the calling thread.";
  throw invalidArgument("workers", workers, `an integer from 0 to ${MAX_WORKERS}, or "auto"`, remedy);
}
