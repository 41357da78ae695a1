/** A queue of calls for what only one call can use at a time: a worker, or the heap of this thread. */

import type { SignalLike } from "../types/platform.js";
import { onAnyAbort, reasonOf } from "./on-abort.js";

/** Items, each of which one call has at a time. Calls get them in their order, those of a batch after all others. */
export class Queue<T> {
  readonly #size: number;
  readonly #idle: T[];
  readonly #waiting: ((item: T) => void)[] = [];
  readonly #ofBatches: ((item: T) => void)[] = [];

  constructor(items: readonly T[]) {
    this.#size = items.length;
    this.#idle = [...items];
  }

  /** Whether an item is free. */
  get hasIdle(): boolean {
    return this.#idle.length > 0;
  }

  /** Takes an item that is free, if there is one. */
  takeIdle(): T | undefined {
    return this.#idle.pop();
  }

  /** Whether a call has an item. */
  get isBusy(): boolean {
    return this.#idle.length < this.#size;
  }

  /**
   * Waits for an item.
   * @throws the reason of the first signal that aborts: a call that waits ends at once
   */
  acquire(signals: readonly SignalLike[], isBatched = false): Promise<T> {
    const waiting = isBatched ? this.#ofBatches : this.#waiting;
    return new Promise((resolve, reject) => {
      for (const signal of signals) if (signal.aborted) return reject(reasonOf(signal));
      const idle = this.#idle.pop();
      if (idle !== undefined) return resolve(idle);
      const take = (item: T) => {
        unfollow();
        resolve(item);
      };
      const giveUp = (reason: unknown) => {
        unfollow();
        waiting.splice(waiting.indexOf(take), 1);
        reject(reason);
      };
      const unfollow = onAnyAbort(signals, giveUp);
      waiting.push(take);
    });
  }

  /** Gives an item back, to the call that has waited longest; to one of a batch if no other call waits. */
  release(item: T): void {
    const next = this.#waiting.shift() ?? this.#ofBatches.shift();
    if (next === undefined) this.#idle.push(item);
    else next(item);
  }
}
