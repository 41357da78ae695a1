/** Engines that run jobs: on the calling thread, or in workers. */
import type { Core, CoreListener } from "./core.js";
import { disposed } from "./error.js";
import type { LoadFormats } from "./formats-module.js";
import { type InSlices, type Job, perform, type Results, runTask } from "./jobs.js";
import { checkSignals } from "./on-abort.js";
import type { ProgressListener } from "./progress.js";
import type { LoadRegistrar } from "./registration-module.js";
import type { LoadedModule } from "./wasm-module.js";

/** Options that control how a call runs. */
export interface Call {
  signal: AbortSignal | undefined;
  progress: ProgressListener;
  /** Whether the arrays of the job may be moved to the worker. */
  transfer: boolean;
}

/** The signals that end a call. */
export const signalsOf = ({ signal, progress }: Call): AbortSignal[] =>
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
  readonly #core: LoadedModule<Core>;
  readonly #formats: LoadFormats;
  readonly #registrar: LoadRegistrar;
  #isDisposed = false;

  constructor(core: LoadedModule<Core>, formats: LoadFormats, registrar: LoadRegistrar) {
    this.#core = core;
    this.#formats = formats;
    this.#registrar = registrar;
  }

  async run<J extends Job>(job: J, call: Call): Promise<Outcome<J>> {
    const { signal, progress } = call;
    const signals = signalsOf(call);
    const check = () => {
      if (this.#isDisposed) throw disposed();
      checkSignals(signals);
    };
    check();
    if (signal !== undefined) {
      // Yields first, so that a pending abort is handled before the thread is busy.
      await turn();
      check();
    }
    const listener: CoreListener = (stage, fraction, best) => progress.report(stage, fraction, best);
    const checked =
      <M>(load: () => Promise<M>) =>
      async () => {
        const module = await load();
        check();
        return module;
      };
    const slices = { sliceMs: SLICE_MS, check, turn };
    const inSlices: InSlices = (begin, input) => runTask(this.#core, begin, input, slices);
    const [formats, registrar] = [checked(this.#formats), checked(this.#registrar)];
    const modules = { core: this.#core, formats, registrar, inSlices };
    return { result: await perform(job, modules, progress.isWanted ? listener : undefined), data: job.data };
  }

  dropMesh(id: number): void {
    this.#core.call((core) => core.dropMesh(id));
  }

  dispose(): void {
    this.#isDisposed = true;
  }
}

/** Yields to timers, events and rendering. */
const turn = () => new Promise<void>((resolve) => setTimeout(resolve));
