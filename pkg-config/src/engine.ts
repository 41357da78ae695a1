/** Engines that run jobs: on the calling thread, or in workers. */

import type { CoreListener } from "./core.js";
import { disposed } from "./error.js";
import { type Job, type Modules, perform, type Results, trackerName } from "./jobs.js";
import type { JointAligner } from "./joint-module.js";
import { beforeAbort, checkSignals } from "./on-abort.js";
import type { SignalLike } from "./platform.js";
import type { ProgressListener } from "./progress.js";
import { heaps, type LoadedModule, releaseHeaps } from "./wasm-module.js";

/** Options that control how a call runs. */
export interface Call {
  signal: SignalLike | undefined;
  progress: ProgressListener;
  /** Whether the arrays of the job may be moved to the worker. */
  transfer: boolean;
}

/** The signals that end a call. */
export const signalsOf = ({ signal, progress }: Call): SignalLike[] =>
  signal === undefined ? [progress.failed] : [signal, progress.failed];

/** The result of a job, and its data after the run. */
export interface Outcome<J extends Job> {
  result: Results[J["method"]];
  data: J["data"];
}

/** Runs jobs. */
export interface Engine {
  /** Number of concurrent jobs that keep the engine busy. */
  readonly capacity: number;
  run<J extends Job>(job: J, call: Call): Promise<Outcome<J>>;
  /** Frees the cached data of a prepared mesh. */
  dropMesh(id: number): void;
  dispose(): void;
}

/** Maximum time that an alignment blocks the thread, in milliseconds. */
const SLICE_MS = 40;

/** Runs jobs on the calling thread. */
export class MainThreadEngine implements Engine {
  readonly capacity = 1;
  readonly #modules: Modules;
  /** The joint module, once a job has needed it. */
  #joint: LoadedModule<JointAligner> | undefined;
  readonly #ended = new AbortController();

  constructor(modules: Modules) {
    this.#modules = modules;
  }

  async run<J extends Job>(job: J, call: Call): Promise<Outcome<J>> {
    const { signal, progress } = call;
    const signals = [this.#ended.signal, ...signalsOf(call)];
    const check = () => checkSignals(signals);
    check();
    if (signal !== undefined) {
      // Yields first, so that a pending abort is handled before the thread is busy.
      await turn();
    }
    const held = await heaps.acquire(signals);
    try {
      check();
      return await this.#perform(job, progress, signals);
    } finally {
      releaseHeaps(held);
    }
  }

  async #perform<J extends Job>(
    job: J,
    progress: ProgressListener,
    signals: readonly SignalLike[],
  ): Promise<Outcome<J>> {
    const check = () => checkSignals(signals);
    const listener: CoreListener = (stage, fraction, best) => progress.report(stage, fraction, best);
    const checked =
      <M>(load: () => Promise<M>) =>
      async () => {
        // A call that waits for the network ends at once: others wait for it.
        const module = await beforeAbort(load(), signals);
        check();
        return module;
      };
    const { core, formats, depthFiles, splats, registrar, joint } = this.#modules;
    const loadJoint = async () => {
      this.#joint = await joint();
      return this.#joint;
    };
    const modules = {
      core,
      formats: checked(formats),
      depthFiles: checked(depthFiles),
      splats: checked(splats),
      registrar: checked(registrar),
      joint: checked(loadJoint),
    };
    const slices = { sliceMs: SLICE_MS, check, turn };
    return { result: await perform(job, modules, progress.isWanted ? listener : undefined, slices), data: job.data };
  }

  dropMesh(id: number): void {
    this.#modules.core.call((core) => core.dropMesh(id));
    this.#joint?.call((joint) => joint.dropMesh(id));
  }

  /** Frees a tracker. */
  closeTracker(id: number): void {
    this.#joint?.call((joint) => joint.closeTracker(id));
    this.#joint?.drop(trackerName(id));
  }

  dispose(): void {
    this.#ended.abort(disposed());
  }
}

/** Yields to timers, events and rendering. */
const turn = () => new Promise<void>((resolve) => setTimeout(resolve));
