/** Reports the progress of the core to the caller. */

import type { Progress } from "../types/options.js";
import type { SignalLike } from "../types/platform.js";
import { invalidArgument } from "../values/error.js";

/** Maximum number of reports per second. */
const MAX_PER_SECOND = 20;

/** Calls `onProgress` with monotonic fractions and a limited rate. */
export class ProgressListener {
  readonly #onProgress: ((progress: Progress) => unknown) | undefined;
  readonly #failed = new AbortController();
  readonly #times: number[] = [];
  #fraction = 0;
  #best: Progress["best"];

  constructor(onProgress: unknown) {
    if (onProgress !== undefined) this.#onProgress = checkedListener(onProgress);
  }

  /** Whether the caller passed `onProgress`. */
  get isWanted(): boolean {
    return this.#onProgress !== undefined;
  }

  /** Aborts when the caller's function throws, when a promise that it returned rejects, and at {@link end}. */
  get failed(): SignalLike {
    return this.#failed.signal;
  }

  /** Ends the calls that it listens to. */
  end(reason: unknown): void {
    this.#failed.abort(reason);
  }

  /**
   * Calls the caller's function, unless it has failed. Does not throw: see {@link failed}.
   * @param best the best pose, column-major, and its score, after a round of the search
   * @param more further properties of the report
   */
  report(stage: Progress["stage"], fraction: number, best?: Float64Array, more: object = {}): void {
    if (this.#onProgress === undefined || this.failed.aborted) return;
    if (best !== undefined) this.#best = { matrix: Array.from(best.subarray(0, 16)), score: best[16] as number };
    this.#fraction = Math.max(this.#fraction, fraction);
    const now = performance.now();
    while (this.#times[0] !== undefined && this.#times[0] <= now - 1000) this.#times.shift();
    // One report per second is reserved for the end.
    const limit = this.#fraction < 1 ? MAX_PER_SECOND - 1 : MAX_PER_SECOND;
    if (this.#times.length >= limit) return;
    this.#times.push(now);
    const fail = (error: unknown) => this.end(error);
    try {
      const returned = this.#onProgress({ stage, fraction: this.#fraction, best: this.#best, ...more });
      // Otherwise, the rejection of an async function would be unhandled, which ends a Node process.
      Promise.resolve(returned).catch(fail);
    } catch (error) {
      fail(error);
    }
  }
}

/** A function that may be called with progress. */
export function checkedListener<F extends (progress: never) => unknown>(onProgress: unknown): F {
  if (typeof onProgress === "function") return onProgress as F;
  throw invalidArgument("options.onProgress", onProgress, "a function", "Pass ({ stage, fraction }) => void.");
}
