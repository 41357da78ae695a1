/** A pool of workers that run jobs in parallel. */

import { checkAttached } from "../attached.js";
import { type Call, type Engine, type MainThreadEngine, type Outcome, signalsOf } from "../engine.js";
import { disposed, Sim3AlignError } from "../error.js";
import { type Job, type MeshCache, meshCacheOf } from "../jobs.js";
import { isAttached } from "../kinds.js";
import { checkSignals, onAbort } from "../on-abort.js";
import type { SignalLike } from "../platform.js";
import { Queue } from "../queue.js";
import { Lending } from "./lending.js";
import { type Answer, JobFailed, Unsendable, WorkerLost, type WorkerSetup, WorkerSlot } from "./slot.js";
import { buffersOf, copied, isSendable, sendableParts } from "./transfer.js";

/** The id of a prepared mesh, and the module that caches it. */
type CachedMesh = { id: number; cache: MeshCache };

/** Attempts per job if its worker is lost. */
const ATTEMPTS = 2;

/** Workers, for which jobs wait in a queue. */
export class WorkerPool implements Engine {
  readonly capacity: number;
  readonly #slots: readonly WorkerSlot[];
  readonly #fallback: MainThreadEngine;
  readonly #queue: Queue<WorkerSlot>;
  readonly #lending: Lending;
  readonly #ended = new AbortController();

  /** @param fallback runs jobs that cannot be cloned; it is disposed with the pool */
  constructor(size: number, setup: WorkerSetup, fallback: MainThreadEngine) {
    // Two per worker: the next job is prepared while one runs.
    this.capacity = 2 * size;
    this.#fallback = fallback;
    this.#slots = Array.from({ length: size }, () => new WorkerSlot(setup));
    this.#queue = new Queue(this.#slots);
    this.#lending = new Lending(this.#queue);
    for (const slot of this.#slots) startEarly(slot);
  }

  async run<J extends Job>(job: J, call: Call): Promise<Outcome<J>> {
    const signals = [this.#ended.signal, ...signalsOf(call)];
    this.#lending.recall();
    const slot = await this.#queue.acquire(signals);
    const stop = (reason: unknown) => {
      slot.end(reason);
      if (!this.#ended.signal.aborted) startEarly(slot);
    };
    const unfollow: (() => void)[] = [];
    try {
      for (const signal of signals) unfollow.push(onAbort(signal, stop));
      return await this.#runIn(slot, job, call, signals);
    } finally {
      for (const end of unfollow) end();
      this.#lending.end(slot);
      this.#queue.release(slot);
      this.#lending.lend();
    }
  }

  dropMesh(id: number): void {
    for (const slot of this.#slots) slot.dropMesh(id);
    this.#fallback.dropMesh(id);
  }

  dispose(): void {
    this.#ended.abort(disposed());
    for (const slot of this.#slots) slot.end(this.#ended.signal.reason);
    this.#fallback.dispose();
  }

  async #runIn<J extends Job>(
    slot: WorkerSlot,
    job: J,
    call: Call,
    signals: readonly SignalLike[],
  ): Promise<Outcome<J>> {
    for (let attempt = 1; ; attempt++) {
      try {
        // A call that has ended must not start a worker, which nothing would end.
        checkSignals(signals);
        await slot.ready();
        const needsHelp = () => this.#lending.ask(slot, job);
        const answer = await send(slot, job, call, signals, needsHelp);
        if (answer === null) {
          // The worker, in which trackers live, does not need the rest; what a pose then lacks is an error there.
          return (await this.#runHere(job, call)) ?? (await this.#runIn(slot, sendableParts(job) as J, call, signals));
        }
        return { result: answer.result, data: answer.data ?? job.data } as Outcome<J>;
      } catch (error) {
        if (error instanceof JobFailed) {
          if (call.transfer) error.error.input = error.data ?? job.data;
          throw error.error;
        }
        if (!(error instanceof WorkerLost)) throw error;
        this.#lending.end(slot);
        if (attempt === ATTEMPTS || isGone(job, call)) throw workerFailed(error);
      }
    }
  }

  /** Runs a job that cannot be sent; `undefined` for one of a tracker in which nothing that matters is wrong. */
  async #runHere<J extends Job>(job: J, call: Call): Promise<Outcome<J> | undefined> {
    const isWhole = isSendable(job);
    try {
      const outcome = await this.#fallback.run(job, call);
      if (isWhole || job.method !== "openTracker") return outcome;
      this.#fallback.closeTracker(job.tracker);
    } catch (error) {
      if (isWhole || (error as Sim3AlignError | undefined)?.code !== "TRACKER_LOST") throw error;
    }
    return undefined;
  }
}

/** Starts a worker in advance. A failure surfaces at the first request. */
function startEarly(slot: WorkerSlot): void {
  try {
    slot.start();
  } catch {}
}

/** Sends a job; `null` if it cannot be sent, so that the core can report what is wrong with it. */
async function send(
  slot: WorkerSlot,
  job: Job,
  { transfer, progress }: Call,
  signals: readonly SignalLike[],
  onNeedsHelp: () => void,
): Promise<Answer | null> {
  const mesh = "meshId" in job && job.meshId !== undefined ? { id: job.meshId, cache: meshCacheOf(job) } : undefined;
  // Buffers of WebAssembly memory and of Node's pool cannot be transferred: they are copied.
  for (const isMoved of transfer ? [true, false] : [false]) {
    // While the job waited for the slot, for a new worker or for the first attempt, it may have been aborted, and its
    // arrays may have been moved to another thread.
    checkSignals(signals);
    checkAttached("input", job.data);
    if (!isSendable(job)) return null;
    try {
      const sent = { ...job, data: sentData(slot, job, isMoved, mesh) } as Job;
      const request = { type: "job", job: sent, wantsProgress: progress.isWanted, returnData: isMoved } as const;
      return await slot.request(request, buffersOf(sent.data), { progress, onNeedsHelp }, mesh);
    } catch (error) {
      if (!(error instanceof Unsendable)) throw error;
    }
  }
  return null;
}

/** The data of a job for a worker. The arrays of a prepared mesh are copied, once to each cache of a worker. */
function sentData(slot: WorkerSlot, job: Job, isMoved: boolean, prepared: CachedMesh | undefined): unknown {
  if (prepared === undefined || job.method === "prepareMesh") return isMoved ? job.data : copied(job.data);
  const { mesh, ...rest } = job.data as { mesh: { warnings?: unknown } };
  const isKnown = slot.hasMesh(prepared.id, prepared.cache);
  return {
    ...(isMoved ? rest : copied(rest)),
    mesh: isKnown ? { positions: new Float32Array(), warnings: mesh.warnings } : copied(mesh),
  };
}

/** Whether the arrays of the job were lost with the worker. */
const isGone = ({ data }: Job, { transfer }: Call) => transfer && buffersOf(data).some((buffer) => !isAttached(buffer));

function workerFailed(cause: WorkerLost): Sim3AlignError {
  return new Sim3AlignError(
    {
      code: "WORKER_FAILED",
      argument: "workers",
      found: `a worker that was lost: ${cause.message}`,
      expected: "a worker that runs until its job is done",
      remedy:
        'Check that worker.js can be loaded and that memory suffices; use fewer workers, or none; in a bundle, import from "sim3align/inline".',
    },
    { cause },
  );
}
