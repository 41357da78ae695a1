/** Who does the jobs: this thread, or workers. */
import type { Core, CoreListener, Formats } from "./core.js";
import { disposed } from "./error.js";
import { type Job, perform, type Results } from "./jobs.js";
import type { ProgressListener } from "./progress.js";
import { type LoadedModule, Stopped } from "./wasm-module.js";

/** How a job is to be done. */
export interface Call {
  signal: AbortSignal | undefined;
  progress: ProgressListener;
  /** Whether the job's arrays may be moved to where it is done. */
  transfer: boolean;
  /** Whether several may share an alignment's search. */
  splitSearch: boolean;
}

/** What came of a job, and its data as they are now. */
export interface Outcome<J extends Job> {
  result: Results[J["method"]];
  data: J["data"];
}

/** Does jobs. */
export interface Engine {
  /** How many jobs it can be given at once without any of them waiting long. */
  readonly capacity: number;
  run<J extends Job>(job: J, call: Call): Promise<Outcome<J>>;
  dispose(): void;
}

/** Does jobs here, one after the other: the thread is busy meanwhile. */
export class HereEngine implements Engine {
  readonly capacity = 1;
  readonly #core: LoadedModule<Core>;
  readonly #formats: () => Promise<LoadedModule<Formats>>;
  #isDisposed = false;

  constructor(core: LoadedModule<Core>, formats: () => Promise<LoadedModule<Formats>>) {
    this.#core = core;
    this.#formats = formats;
  }

  async run<J extends Job>(job: J, { signal, progress }: Call): Promise<Outcome<J>> {
    const check = () => {
      if (this.#isDisposed) throw disposed();
      signal?.throwIfAborted();
    };
    check();
    if (signal !== undefined) {
      // This thread is about to be busy: whoever wants to abort gets a turn.
      await new Promise((resolve) => setTimeout(resolve));
      check();
    }
    const listener: CoreListener = (stage, fraction, best) => {
      try {
        check();
        progress.report(stage, fraction, best);
        check();
      } catch (error) {
        throw new Stopped(error);
      }
    };
    const formats = async () => {
      const module = await this.#formats();
      check();
      return module;
    };
    const isFollowed = progress.isWanted || signal !== undefined;
    const tools = { core: this.#core, formats };
    return { result: await perform(job, tools, isFollowed ? listener : undefined), data: job.data };
  }

  dispose(): void {
    this.#isDisposed = true;
  }
}
