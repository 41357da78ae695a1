/** A pool of workers that run jobs in parallel. */
import { type DataOf, type Job, type Method, moduleOf, type ResultOf } from "../calls/calls.js";
import { type Call, checkReady, type Engine, type MainThreadEngine, type Outcome, signalsOf } from "../calls/engine.js";
import { beforeAbort, checkSignals, onAnyAbort } from "../concurrency/on-abort.js";
import { Queue } from "../concurrency/queue.js";
import type { ModuleName } from "../modules/exports.js";
import type { CompiledModule } from "../modules/module.js";
import type { SignalLike } from "../types/platform.js";
import { disposed, type ErrorParts, failure, partsOf, Sim3AlignError } from "../values/error.js";
import { isAttached } from "../values/kinds.js";
import { buffersOf, copied, isSendable, sendableParts } from "../values/transfer.js";
import { HelperBroker } from "./helper-broker.js";
import type { Answer, Report } from "./messages.js";
import { Slot, WorkerLost, type WorkerSetup } from "./pool-worker.js";

/** Attempts per job if its worker is lost. */
const ATTEMPTS = 2;

/** Workers, for which jobs wait in a queue. */
export class WorkerPool implements Engine {
  readonly capacity: number;
  readonly #slots: readonly Slot[];
  readonly #queue: Queue<Slot>;
  readonly #broker: HelperBroker;
  readonly #ended = new AbortController();

  /** @param fallback runs jobs that cannot be cloned; it is disposed with the pool */
  constructor(
    size: number,
    private readonly setup: WorkerSetup,
    private readonly fallback: MainThreadEngine,
  ) {
    // Two per worker: the next job is prepared while one runs.
    this.capacity = 2 * size;
    this.#slots = Array.from({ length: size }, () => new Slot(setup));
    this.#queue = new Queue(this.#slots);
    this.#broker = new HelperBroker(this.#queue, setup.compiled);
  }

  async run<M extends Method>(job: Job<M>, call: Call): Promise<Outcome<M>> {
    const signals = [this.#ended.signal, ...signalsOf(call)];
    this.#broker.recall();
    const slot = await this.#queue.acquire(signals, call.isBatched);
    const stop = (reason: unknown) => {
      slot.last.end(reason);
      if (!this.#ended.signal.aborted) slot.ensureWorker();
    };
    const unfollow = onAnyAbort(signals, stop);
    try {
      return await this.#runIn(slot, job, call, signals);
    } finally {
      unfollow();
      this.#broker.end(slot);
      this.#queue.release(slot);
      this.#broker.lend();
    }
  }

  dropMesh(id: number): void {
    for (const { last } of this.#slots) last.dropMesh(id);
    this.fallback.dropMesh(id);
  }

  dispose(): void {
    this.#ended.abort(disposed());
    for (const { last } of this.#slots) last.end(this.#ended.signal.reason);
    this.fallback.dispose();
  }

  async #runIn<M extends Method>(
    slot: Slot,
    given: Job<M>,
    call: Call,
    signals: readonly SignalLike[],
  ): Promise<Outcome<M>> {
    let job = given;
    let failures = 0;
    const modules = new Map<ModuleName, CompiledModule>();
    const needed = new Set<ModuleName>(["core", moduleOf(job.method)]);
    const failed = (parts: ErrorParts) => {
      const error = new Sim3AlignError(parts);
      if (call.transfer) error.input = job.data;
      return error;
    };
    const compiled = (name: ModuleName) =>
      this.setup.compiled(name).catch((error) => {
        throw error instanceof Sim3AlignError ? failed(partsOf(error)) : error;
      });
    for (;;) {
      try {
        // A call that has ended must not start a worker, which nothing would end.
        checkSignals(signals);
        for (const name of needed) modules.set(name, await beforeAbort(compiled(name), signals));
        await slot.ensureWorker().ready();
        const answer = await this.#send(slot, job, modules, call, signals);
        if (answer === undefined) {
          // A tracker lives in its worker, which does not need the rest: what a pose then lacks is an error there.
          const isTracked = "tracker" in job.options && !isSendable(job);
          if (!isTracked) return await this.fallback.run(job, call);
          job = sendableParts(job);
          continue;
        }
        if (answer.data !== undefined) job = { ...job, data: returnedData(job, answer.data as DataOf<M>) };
        if (answer.error !== undefined) throw failed(answer.error);
        if (answer.needs === undefined) return { result: answer.result as ResultOf<M>, data: job.data };
        needed.add(answer.needs);
      } catch (error) {
        if (!(error instanceof WorkerLost)) throw error;
        this.#broker.end(slot);
        failures += 1;
        if (failures === ATTEMPTS || isGone(job, call)) throw workerFailed(error);
      }
    }
  }

  /** Sends a job; `undefined` if it cannot be sent, so that the core can report what is wrong with it. */
  async #send(
    slot: Slot,
    job: Job,
    modules: ReadonlyMap<ModuleName, CompiledModule>,
    { transfer, progress }: Call,
    signals: readonly SignalLike[],
  ): Promise<Answer | undefined> {
    const { method, meshId } = job;
    const mesh = meshId === undefined ? undefined : { id: meshId, module: moduleOf(method) };
    const report = (message: Report) => {
      if (message.stage === undefined) this.#broker.ask(slot, job);
      else progress.report(message.stage, message.fraction, message.best);
    };
    // Buffers of WebAssembly memory and of Node's pool cannot be transferred: they are copied.
    for (const isMoved of transfer ? [true, false] : [false]) {
      checkReady(job, signals);
      if (!isSendable(job)) return undefined;
      const data = sentData(job, isMoved, mesh && slot.last.hasMesh(mesh));
      const sent = { job: { ...job, data }, wantsProgress: progress.isWanted, returnsData: isMoved };
      const answer = await slot.last.request({ ...sent, transfer: buffersOf(data), modules, mesh, report });
      if (answer !== undefined) return answer;
    }
    return undefined;
  }
}

/**
 * The data of a job for a worker. The arrays of a prepared mesh are copied, once to each cache of a worker.
 * @param isCached whether the worker has cached the prepared mesh; `undefined` if there is none
 */
function sentData({ method, data }: Job, isMoved: boolean, isCached: boolean | undefined): DataOf<Method> {
  const sent = <T>(value: T) => (isMoved ? value : copied(value));
  if (isCached === undefined || method === "prepareMesh" || !("mesh" in data)) return sent(data);
  const { mesh, ...rest } = data;
  const { warnings } = mesh as { warnings?: unknown };
  return { ...sent(rest), mesh: isCached ? { positions: new Float32Array(), warnings } : copied(mesh) } as typeof data;
}

/** The data that a worker has returned. A prepared mesh was not moved there, and may come back without its arrays. */
const returnedData = <M extends Method>({ method, data, meshId }: Job<M>, returned: DataOf<M>): DataOf<M> =>
  meshId === undefined || method === "prepareMesh" || !("mesh" in data) ? returned : { ...returned, mesh: data.mesh };

/** Whether the arrays of the job were lost with the worker. */
const isGone = ({ data }: Job, { transfer }: Call) => transfer && buffersOf(data).some((buffer) => !isAttached(buffer));

function workerFailed(cause: WorkerLost): Sim3AlignError {
  const found = `a worker that was lost: ${cause.message}`;
  const remedy =
    'Check that worker.js can be loaded and that memory suffices; use fewer workers, or none; in a bundle, import from "sim3align/inline".';
  return failure("WORKER_FAILED", "workers", found, "a worker that runs until its job is done", remedy, cause);
}
