/** Progress on its way to the caller. */
import { invalidArgument } from "./error.js";
import type { BestSoFar, Progress } from "./options.js";

/** Reports a second at most. */
const MAX_PER_SECOND = 20;

/** Hands progress on: never backwards, and not more often than a display can use. */
export class ProgressListener {
  readonly #onProgress: ((progress: Progress) => void) | undefined;
  readonly #times: number[] = [];
  #fraction = 0;
  #best: BestSoFar | undefined;

  constructor(onProgress: unknown) {
    if (onProgress === undefined) return;
    if (typeof onProgress !== "function") {
      throw invalidArgument("options.onProgress", onProgress, "a function", "Pass ({ stage, fraction }) => void.");
    }
    this.#onProgress = onProgress as (progress: Progress) => void;
  }

  /** Whether anybody listens. */
  get isWanted(): boolean {
    return this.#onProgress !== undefined;
  }

  /**
   * Calls the caller's function, whose exceptions are the caller's.
   * @param best the best pose, column by column, and its score, where there is news of it
   */
  report(stage: Progress["stage"], fraction: number, best?: Float64Array): void {
    if (this.#onProgress === undefined) return;
    if (best !== undefined) this.#best = { matrix: best.slice(0, 16), score: best[16] as number };
    this.#fraction = Math.max(this.#fraction, fraction);
    const now = performance.now();
    while (this.#times[0] !== undefined && this.#times[0] <= now - 1000) this.#times.shift();
    // The last place is kept for the end.
    const limit = this.#fraction < 1 ? MAX_PER_SECOND - 1 : MAX_PER_SECOND;
    if (this.#times.length >= limit) return;
    this.#times.push(now);
    this.#onProgress({ stage, fraction: this.#fraction, best: this.#best });
  }
}
