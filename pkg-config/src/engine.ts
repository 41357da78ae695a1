/** Engines that run jobs: on the calling thread, or in workers. */

import { checkAttached } from "./attached.js";
import type { Core, CoreListener } from "./core.js";
import { disposed, withoutInput } from "./error.js";
import type { LoadFormats } from "./formats-module.js";
import { type InSlices, type Job, perform, type Results, type Task } from "./jobs.js";
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
    const inSlices: InSlices = (begin, input) => runInSlices(this.#core, begin, input, check);
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

/** Runs a task in time slices. Between them, the thread yields, and `check` may throw. */
async function runInSlices<T>(
  core: LoadedModule<Core>,
  begin: (core: Core) => Task<T>,
  input: object,
  check: () => void,
): Promise<T> {
  // The thread may have been elsewhere since the input was read.
  checkAttached("input", input);
  const task = core.call(begin, withoutInput);
  const { instance } = core;
  try {
    for (;;) {
      const result = core.call(() => task.step(SLICE_MS), withoutInput);
      check();
      if (result !== undefined) return result;
      await turn();
      check();
      // Another call trapped, and the task was lost with its instance.
      if (core.instance !== instance) return await runInSlices(core, begin, input, check);
    }
  } finally {
    if (core.instance === instance) task.free();
  }
}
