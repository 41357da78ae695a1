/** A job while it runs: its modules, its listener, and how it shares its thread. */

import type { Alignment, ViewsAlignment } from "../generated/types.js";
import type { CoreInput, CoreViews } from "../modules/core-input.js";
import type {
  CoreHelpers,
  CoreListener,
  Exports,
  Helper,
  ModuleName,
  Placed,
  PlacedInput,
  Task,
} from "../modules/exports.js";
import type { LoadedModule, Modules } from "../modules/module.js";
import { isOfInput, withoutInput } from "../values/error.js";
import type { CoreMesh } from "../values/prepared-mesh.js";

/** The searches, with which other threads may help. */
interface Searches {
  align: { module: "core"; input: CoreInput; result: Alignment };
  place: { module: "joint"; input: PlacedInput; result: Placed };
  alignViews: { module: "joint"; input: CoreViews; result: ViewsAlignment };
}

/** The functions of a module that run a search: on its thread, and on those of helpers. */
interface Search<G, I, T> {
  begin(exports: G, input: I, options: object, listener?: CoreListener, helpers?: CoreHelpers): Task<T>;
  help(exports: G, input: I, options: object): Helper;
}

type SearchOf<S extends keyof Searches> = Search<
  Exports[Searches[S]["module"]],
  Searches[S]["input"],
  Searches[S]["result"]
> & { module: Searches[S]["module"] };

const searches: { readonly [S in keyof Searches]: SearchOf<S> } = {
  align: {
    module: "core",
    begin: (core, ...search) => core.beginAlign(...search),
    help: (core, ...search) => core.beginHelp(...search),
  },
  place: {
    module: "joint",
    begin: (joint, ...search) => joint.beginPlace(...search),
    help: (joint, ...search) => joint.beginHelpPlace(...search),
  },
  alignViews: {
    module: "joint",
    begin: (joint, ...search) => joint.beginAlignViews(...search),
    help: (joint, ...search) => joint.beginHelpViews(...search),
  },
};

/** A search, for those that help with it. A prepared mesh comes to them from where it was prepared. */
export interface SharedSearch<S extends keyof Searches = keyof Searches> {
  search: S;
  input: Searches[S]["input"];
  options: object;
}

/** Divides the thread between tasks. */
export interface Scheduler {
  /** About how long each slice takes, milliseconds. */
  readonly sliceMs: number;
  /** Called after each slice and each turn; may throw. */
  check(): void;
  /** Gives the thread away between two slices. */
  turn(): Promise<void>;
  /** The helpers of a search, if it may have any. */
  helpersFor?(search: SharedSearch): CoreHelpers | undefined;
}

/** The part of a call that calibration takes, where it is one. */
const CALIBRATION = 0.7;

/** A job that runs. */
export class JobContext {
  /** @param listener called when stages begin; if it throws, the job fails with that exception */
  constructor(
    readonly modules: Modules,
    private readonly scheduler: Scheduler,
    readonly listener: CoreListener | undefined,
  ) {}

  /** The calibration of a call, and what follows. */
  parts(): [first: JobContext, then: JobContext] {
    const { modules, listener } = this;
    const of = (part: CoreListener) => new JobContext(modules, this.scheduler, listener && part);
    return [
      // Poses of a calibration that is not known yet are nothing to show.
      of((stage, fraction) => listener?.(stage, CALIBRATION * fraction)),
      of((stage, fraction, best) => listener?.(stage, CALIBRATION + (1 - CALIBRATION) * fraction, best)),
    ];
  }

  /** The same job without progress. */
  quiet(): JobContext {
    return new JobContext(this.modules, this.scheduler, undefined);
  }

  /** Another alignment, without progress and metrics; `undefined` where its input allows none. An abort or a crash ends the job. */
  another(input: CoreInput, options: object): Promise<Alignment | undefined> {
    const search = this.quiet().search("align", input, { ...options, metrics: false });
    return search.catch((error) => {
      if (isOfInput(error)) return undefined;
      throw error;
    });
  }

  /** Calls a module with an input. */
  async call<N extends ModuleName, T>(name: N, input: object, work: (exports: Exports[N]) => T): Promise<T> {
    const module: LoadedModule<Exports[N]> = await this.modules[name]();
    return module.callWith("input", input, work);
  }

  /** Runs a task to its end, and frees it. `input` is what its beginning reads. */
  async task<N extends ModuleName, T>(name: N, input: object, begin: (exports: Exports[N]) => Task<T>): Promise<T> {
    const module: LoadedModule<Exports[N]> = await this.modules[name]();
    const { scheduler } = this;
    scheduler.check();
    for (;;) {
      const task = module.callWith("input", input, (exports) => module.kept(begin(exports)));
      const { instance } = module;
      try {
        // Until another call traps: the task is then lost with its instance.
        while (module.instance === instance) {
          const result = module.call(() => task.step(scheduler.sliceMs), withoutInput);
          scheduler.check();
          if (result !== undefined) return result;
          await scheduler.turn();
          scheduler.check();
        }
      } finally {
        if (module.instance === instance) task.free();
        module.drop(task);
      }
    }
  }

  /** Runs a search to its end. */
  search<S extends keyof Searches>(
    search: S,
    input: Searches[S]["input"],
    options: object,
  ): Promise<Searches[S]["result"]> {
    const { module, begin }: SearchOf<S> = searches[search];
    const { id } = input.mesh;
    const mesh = id === undefined ? input.mesh : { positions: new Float32Array(), id };
    const helpers = this.scheduler.helpersFor?.({ search, input: { ...input, mesh }, options });
    return this.task(module, input, (exports) => begin(exports, input, options, this.listener, helpers));
  }
}

/** Help with a search: its module is called with {@link Helper}, until it is over. */
export interface SearchHelp {
  call<T>(work: (helper: Helper) => T): T;
  end(): void;
}

/**
 * Prepares help with a search.
 * @param mesh the arrays of its prepared mesh, unless the module has them
 */
export async function beginHelp<S extends keyof Searches>(
  { search, input, options }: SharedSearch<S>,
  mesh: CoreMesh | undefined,
  modules: Modules,
): Promise<SearchHelp> {
  const { module: name, help }: SearchOf<S> = searches[search];
  const { id } = input.mesh;
  const own = mesh === undefined || id === undefined ? input : { ...input, mesh: { ...mesh, id } };
  const module: LoadedModule<Exports[Searches[S]["module"]]> = await modules[name]();
  const helper = module.call((exports) => module.kept(help(exports, own, options)));
  const { instance } = module;
  return {
    call: (work) => module.call(() => work(helper)),
    end() {
      if (module.instance === instance) helper.free();
      module.drop(helper);
    },
  };
}
