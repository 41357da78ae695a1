/** Engines that run jobs: on the calling thread, or in workers. */

import { beforeAbort, checkSignals } from "../concurrency/on-abort.js";
import type { CoreListener, Exports, ModuleName } from "../modules/exports.js";
import {
  heaps,
  type LoadedModule,
  type Modules,
  type ModuleTable,
  modulesBy,
  releaseHeaps,
} from "../modules/module.js";
import type { SignalLike } from "../types/platform.js";
import { checkAttached } from "../values/border.js";
import { disposed } from "../values/error.js";
import { type DataOf, dropMesh, type Job, type Method, perform, type ResultOf, trackerName } from "./calls.js";
import { JobContext } from "./context.js";
import type { ProgressListener } from "./progress.js";

/** Options that control how a call runs. */
export interface Call {
  signal: SignalLike | undefined;
  progress: ProgressListener;
  /** Whether the arrays of the job may be moved to the worker. */
  transfer: boolean;
  /** Whether the call belongs to a batch: other calls go first. */
  isBatched?: boolean;
}

/** The signals that end a call. */
export const signalsOf = ({ signal, progress }: Call): SignalLike[] =>
  signal === undefined ? [progress.failed] : [signal, progress.failed];

/** The result of a job, and its data after the run. */
export interface Outcome<M extends Method> {
  result: ResultOf<M>;
  data: DataOf<M>;
}

/** Runs jobs. */
export interface Engine {
  /** Number of concurrent jobs that keep the engine busy. */
  readonly capacity: number;
  run<M extends Method>(job: Job<M>, call: Call): Promise<Outcome<M>>;
  /** Frees the cached data of a prepared mesh. */
  dropMesh(id: number): void;
  dispose(): void;
}

/**
 * Checks a job right before it is sent or performed: while it waited, it may have been aborted, and other threads may have got
 * the memory of its arrays.
 */
export function checkReady({ data }: Job, signals: readonly SignalLike[]): void {
  checkSignals(signals);
  checkAttached("input", data);
}

/** Maximum time that an alignment blocks the thread, in milliseconds. */
const SLICE_MS = 40;

/** Runs jobs on the calling thread. */
export class MainThreadEngine implements Engine {
  readonly capacity = 1;
  readonly #ended = new AbortController();

  /** @param modules loads the modules of the table */
  constructor(
    private readonly table: ModuleTable,
    private readonly modules: Modules,
  ) {}

  async run<M extends Method>(job: Job<M>, call: Call): Promise<Outcome<M>> {
    const signals = [this.#ended.signal, ...signalsOf(call)];
    checkSignals(signals);
    // Yields first, so that a pending abort is handled before the thread is busy.
    if (call.signal !== undefined) await turn();
    const held = await heaps.acquire(signals, call.isBatched);
    try {
      checkReady(job, signals);
      const result = await perform(job, this.#context(call, signals));
      // A call may go on without a part that an abort has ended.
      checkSignals(signals);
      return { result, data: job.data };
    } finally {
      releaseHeaps(held);
    }
  }

  #context({ progress }: Call, signals: readonly SignalLike[]): JobContext {
    const check = () => checkSignals(signals);
    const load = async <N extends ModuleName>(name: N): Promise<LoadedModule<Exports[N]>> => {
      // A call that waits for the network ends at once: others wait for it.
      const module = await beforeAbort(this.modules[name](), signals);
      check();
      return module;
    };
    const listener: CoreListener = (stage, fraction, best) => progress.report(stage, fraction, best);
    return new JobContext(
      modulesBy(load),
      { sliceMs: SLICE_MS, check, turn },
      progress.isWanted ? listener : undefined,
    );
  }

  dropMesh(id: number): void {
    dropMesh(id, this.table);
  }

  /** Frees a tracker. */
  closeTracker(id: number): void {
    const joint = this.table.joint.loaded;
    joint?.call((j) => j.closeTracker(id));
    joint?.drop(trackerName(id));
  }

  dispose(): void {
    this.#ended.abort(disposed());
  }
}

/** Yields to timers, events and rendering. */
const turn = () => new Promise<void>((resolve) => setTimeout(resolve));
