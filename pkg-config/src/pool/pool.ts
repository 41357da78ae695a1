/** A pool of workers that does jobs side by side. */

import type { Call, Engine, Outcome } from "../engine.js";
import { disposed, Sim3AlignError } from "../error.js";
import type { Job } from "../jobs.js";
import { onAbort } from "../on-abort.js";
import { buffersOf, copied } from "../transfer.js";
import { type Answer, JobFailed, type Supplies, Unsendable, WorkerLost, WorkerSlot } from "./slot.js";
import { canBeSplit, splitAlign } from "./split.js";

/** How often a job is tried whose worker is lost. */
const ATTEMPTS = 2;

/** Workers, and whoever waits for one. */
export class WorkerPool implements Engine {
  readonly capacity: number;
  readonly #slots: readonly WorkerSlot[];
  readonly #here: Engine;
  readonly #idle: WorkerSlot[];
  readonly #waiting: ((slot: WorkerSlot) => void)[] = [];
  readonly #ended = new AbortController();

  /** @param here does what can't be sent to a worker */
  constructor(width: number, supplies: Supplies, here: Engine) {
    // While one is being handed over, the next one is being worked on.
    this.capacity = 2 * width;
    this.#here = here;
    this.#slots = Array.from({ length: width }, () => new WorkerSlot(supplies));
    this.#idle = [...this.#slots];
    for (const slot of this.#slots) startEarly(slot);
  }

  async run<J extends Job>(job: J, call: Call): Promise<Outcome<J>> {
    const signals = [this.#ended.signal, ...(call.signal === undefined ? [] : [call.signal])];
    const slots = [await this.#acquire(signals)];
    if (call.splitSearch && canBeSplit(job)) slots.push(...this.#idle.splice(0));
    const stop = (reason: unknown) => {
      for (const slot of slots) {
        slot.end(reason);
        if (!this.#ended.signal.aborted) startEarly(slot);
      }
    };
    const endings: (() => void)[] = [];
    try {
      for (const signal of signals) {
        // Since the slot was given, a moment has passed.
        signal.throwIfAborted();
        endings.push(onAbort(signal, stop));
      }
      return await this.#attempt(job, call, slots);
    } finally {
      for (const end of endings) end();
      for (const slot of slots) this.#release(slot);
    }
  }

  dispose(): void {
    this.#ended.abort(disposed());
    for (const slot of this.#slots) slot.end(this.#ended.signal.reason);
  }

  async #attempt<J extends Job>(job: J, call: Call, slots: WorkerSlot[]): Promise<Outcome<J>> {
    const [slot] = slots as [WorkerSlot];
    if (slots.length > 1 && canBeSplit(job)) {
      const result = await splitAlign(slots, job, call);
      if (result !== null) return { result, data: job.data } as Outcome<J>;
    }
    for (let attempt = 1; ; attempt++) {
      try {
        const answer = await send(slot, job, call);
        if (answer === null) return await this.#here.run(job, call);
        return { result: answer.result, data: answer.data ?? job.data } as Outcome<J>;
      } catch (error) {
        if (error instanceof JobFailed)
          throw withData(error.error, call.transfer ? (error.data ?? job.data) : undefined);
        if (!(error instanceof WorkerLost)) throw error;
        if (attempt === ATTEMPTS || isGone(job, call)) throw workerFailed(error);
      }
    }
  }

  #acquire(signals: readonly AbortSignal[]): Promise<WorkerSlot> {
    return new Promise((resolve, reject) => {
      for (const signal of signals) if (signal.aborted) return reject(signal.reason);
      const slot = this.#idle.pop();
      if (slot !== undefined) return resolve(slot);
      const take = (freed: WorkerSlot) => {
        for (const end of endings) end();
        resolve(freed);
      };
      const giveUp = (reason: unknown) => {
        for (const end of endings) end();
        this.#waiting.splice(this.#waiting.indexOf(take), 1);
        reject(reason);
      };
      const endings = signals.map((signal) => onAbort(signal, giveUp));
      this.#waiting.push(take);
    });
  }

  #release(slot: WorkerSlot): void {
    const next = this.#waiting.shift();
    if (next === undefined) this.#idle.push(slot);
    else next(slot);
  }
}

/** Saves the first request the time; where it fails, that request says so. */
function startEarly(slot: WorkerSlot): void {
  try {
    slot.start();
  } catch {}
}

/** Asks for a job; `null` where it can't be sent: whatever the clone algorithm refuses, the core has words for. */
async function send(slot: WorkerSlot, job: Job, { transfer, progress }: Call): Promise<Answer | null> {
  // Buffers of WebAssembly memory and of Node's pool can't be moved: they are copied after all.
  for (const isMoved of transfer ? [true, false] : [false]) {
    try {
      const sent = isMoved ? job : { ...job, data: copied(job.data) as never };
      const request = { type: "job", job: sent, wantsProgress: progress.isWanted, returnData: isMoved } as const;
      return await slot.request(request, buffersOf(sent.data), progress);
    } catch (error) {
      if (!(error instanceof Unsendable)) throw error;
    }
  }
  return null;
}

/** Whether the job's arrays went with the worker. */
const isGone = ({ data }: Job, { transfer }: Call) =>
  transfer && buffersOf(data).some((buffer) => buffer.byteLength === 0);

function withData(error: Sim3AlignError, data: unknown): Sim3AlignError {
  if (data !== undefined) error.input = data;
  return error;
}

function workerFailed(cause: WorkerLost): Sim3AlignError {
  return new Sim3AlignError(
    {
      code: "WORKER_FAILED",
      argument: "workers",
      found: `a worker that was lost: ${cause.message}`,
      expected: "a worker that lives until its job is done",
      remedy: "Check that worker.js can be loaded and that memory suffices, use fewer workers, or none.",
    },
    { cause },
  );
}
