/// <reference lib="esnext.disposable" preserve="true" />
/** The package's one class. */
import { alignAll } from "./align-all.js";
import { type Core, coreModule } from "./core.js";
import { type Engine, MainThreadEngine } from "./engine.js";
import { disposed, invalidArgument, Sim3AlignError } from "./error.js";
import { formatsModule } from "./formats-module.js";
import type { AlignInput } from "./input/types.js";
import type { Job, Results } from "./jobs.js";
import type {
  AlignAllOptions,
  AlignOptions,
  CallOptions,
  Defaults,
  EstimateOptions,
  EvaluateOptions,
  Progress,
  RegisterOptions,
} from "./options.js";
import type { CreateWorker, WasmSource } from "./platform.js";
import { WorkerPool } from "./pool/pool.js";
import { workerFactory } from "./pool/port.js";
import { ProgressListener } from "./progress.js";
import type { AlignAllResult, Alignment, Evaluation, Registration } from "./results.js";
import { coreSim3, type Sim3Like } from "./sim3.js";
import { isKind, isRecord, withoutUndefined } from "./values.js";
import type { LazySource, LoadedModule } from "./wasm-module.js";

/** What `createAligner` can be told. */
export interface AlignerOptions {
  /** Where the core module comes from. By default `wasm/core_bg.wasm` beside this script. */
  wasm?: WasmSource | undefined;
  /** Where the file readers come from, once a file is passed. By default `wasm/formats_bg.wasm` beside this script. */
  formatsWasm?: WasmSource | undefined;
  /**
   * How many workers do the work: 0 (the default) does it on the calling thread; `"auto"` is one less than the machine
   * has cores, 1 to 8. The workers are this package's `worker.js`, run as module `Worker`s, or by Node as
   * `node:worker_threads`; they need neither shared memory nor special headers. Node's process does not wait for idle
   * ones.
   */
  workers?: number | "auto" | undefined;
  /** Makes a worker that runs this package's `worker.js`, where that can't be found beside this script. */
  createWorker?: CreateWorker | undefined;
}

/** The files that `sim3align/inline` brings along. */
export interface BundledAssets {
  wasm?: LazySource;
  formatsWasm?: LazySource;
  workerScript?: string;
}

/** Workers that "auto" starts at most: each has a copy of its input. */
const MAX_AUTO = 8;

/**
 * Loads the core module and makes an aligner. The module is loaded once and shared by all aligners, whose state is
 * their own, so this can be called anywhere, any number of times; only the first call's `wasm` counts.
 * @throws {@link Sim3AlignError} `NOT_INITIALISED` where the module can't be loaded; the next call tries again
 */
export async function createAligner(options: AlignerOptions = {}): Promise<Aligner> {
  return Aligner.create(options);
}

/**
 * Finds similarity transforms. Every method rejects with {@link Sim3AlignError}, after which the aligner works on; none
 * changes its arguments or keeps them. With workers, the arguments are copied to them when their turn comes: leave them
 * as they are until the call is over.
 */
export class Aligner {
  readonly #core: LoadedModule<Core>;
  readonly #engine: Engine;
  #isDisposed = false;

  private constructor(core: LoadedModule<Core>, engine: Engine) {
    this.#core = core;
    this.#engine = engine;
  }

  /** @internal */
  static async create(options: AlignerOptions, assets: BundledAssets = {}): Promise<Aligner> {
    const { wasm = assets.wasm, formatsWasm = assets.formatsWasm } = options;
    const workers = checkedWorkers(options.workers);
    const core = await coreModule.load(wasm);
    const mainThread = new MainThreadEngine(core, () => formatsModule.load(formatsWasm));
    if (workers === 0) return new Aligner(core, mainThread);
    const { createWorker } = options;
    const factory = await workerFactory(assets.workerScript, createWorker);
    const size = workers === "auto" ? Math.min(Math.max(factory.cores - 1, 1), MAX_AUTO) : workers;
    const setup = {
      create: factory.create,
      core: await coreModule.compile(),
      formats: () => formatsModule.compile(formatsWasm),
    };
    return new Aligner(core, new WorkerPool(size, setup, mainThread));
  }

  /**
   * Puts a mesh where a depth map shows it, at its real size: x_cam = s·R·p_mesh + t, OpenCV camera frame (x right, y
   * down, z forward), metres. The same input, options and seed give the same bits, with any number of workers.
   *
   * The result says how sure it is (`confidence`), which other poses explain the same picture (`alternatives`), and
   * which parts of the pose the view leaves open (`uncertainty`).
   * @throws {@link Sim3AlignError} for bad input, `INVALID_OPTION` for options that contradict each other, and `NO_CONSENSUS` where nothing that the data support was found
   */
  async align(input: AlignInput, options: AlignOptions = {}): Promise<Alignment> {
    const { initial, onProgress, ...rest } = checkedOptions(options);
    const coreOptions = initial === undefined ? rest : { ...rest, initial: coreSim3(initial) };
    return this.#run("align", input, coreOptions, { onProgress });
  }

  /**
   * Aligns many inputs, and yields each result as it is ready: `{ index, alignment }`, or `{ index, error }` where
   * an input is at fault, after which the others go on. Inputs are pulled as there is room: at most twice as many as
   * there are workers (one, without workers) have been pulled and not been yielded, so that inputs that are read on
   * demand never fill the memory. Leaving the loop ends what is under way.
   * @example
   * ```ts
   * for await (const { index, alignment, error } of aligner.alignAll(inputs)) console.log(index, alignment ?? error);
   * ```
   * @throws what `inputs` throws, the reason of an aborted signal, and {@link Sim3AlignError} `DISPOSED`
   */
  async *alignAll(
    inputs: Iterable<AlignInput> | AsyncIterable<AlignInput>,
    options: AlignAllOptions = {},
  ): AsyncGenerator<AlignAllResult, void, undefined> {
    this.#checkUsable();
    const { ordered = false, onProgress, signal, ...rest } = checkedOptions(options);
    yield* alignAll(inputs, {
      limit: this.#engine.capacity,
      ordered: checkedFlag("ordered", ordered),
      signal: checkedSignal(signal),
      align: (input, index, signal) => {
        const own = onProgress && { onProgress: (progress: Progress) => onProgress({ ...progress, index }) };
        return this.align(input, { ...rest, ...own, signal });
      },
      isOwn: (error): error is Sim3AlignError => error instanceof Sim3AlignError && error.code !== "DISPOSED",
    });
  }

  /**
   * Scores a transform on an input with the metrics of `align`, and against the truth where `options` has it.
   * @param transform camera from mesh, metres
   * @throws {@link Sim3AlignError} for bad input, `INVALID_TRANSFORM` for what is no similarity
   */
  async evaluate(input: AlignInput, transform: Sim3Like, options: EvaluateOptions = {}): Promise<Evaluation> {
    const { truth, ...rest } = checkedOptions(options);
    const coreOptions = truth === undefined ? rest : { ...rest, truth: coreSim3(truth) };
    return this.#run("evaluate", input, coreOptions, { transform: coreSim3(transform) });
  }

  /**
   * Aligns a point cloud to another, which may overlap in part only: y = s·R·x + t.
   * @param source x, y, z one after the other, in any unit
   * @param target x, y, z one after the other, in any unit
   * @throws {@link Sim3AlignError} for bad input, and `NO_CONSENSUS` where nothing that the data support was found
   */
  async register(
    source: Float32Array | Float64Array,
    target: Float32Array | Float64Array,
    options: RegisterOptions = {},
  ): Promise<Registration> {
    return this.#run("register", { source, target }, checkedOptions(options));
  }

  /**
   * Finds the transform that the most correspondences agree on, whatever matched the points: y = s·R·x + t.
   * @param source x, y, z one after the other, in any unit
   * @param target x, y, z one after the other, in any unit
   * @param correspondences index of a source point, index of its target point, one pair after the other
   * @throws {@link Sim3AlignError} for bad input, and `NO_CONSENSUS` where too few correspondences agree
   */
  async estimateSim3(
    source: Float32Array | Float64Array,
    target: Float32Array | Float64Array,
    correspondences: Uint32Array,
    options: EstimateOptions = {},
  ): Promise<Registration> {
    return this.#run("estimateSim3", { source, target, correspondences }, checkedOptions(options));
  }

  /** The values that options take where they are left out. */
  async defaults(): Promise<Defaults> {
    this.#checkUsable();
    return this.#core.call((core) => core.defaults());
  }

  /** Which build the core is. */
  async buildInfo(): Promise<{ version: string }> {
    this.#checkUsable();
    return this.#core.call((core) => ({ version: core.version() }));
  }

  /**
   * Ends the aligner and its workers: calls that are under way, and later ones, reject with `DISPOSED`. The modules stay
   * loaded for others.
   */
  dispose(): void {
    if (this.#isDisposed) return;
    this.#isDisposed = true;
    this.#engine.dispose();
  }

  /** The same, for `using`. */
  [Symbol.dispose](): void {
    this.dispose();
  }

  async #run<M extends Job["method"]>(
    method: M,
    data: (Job & { method: M })["data"],
    { signal, transfer = false, ...options }: CallOptions,
    { onProgress, ...more }: { onProgress?: unknown; transform?: unknown } = {},
  ): Promise<Results[M]> {
    this.#checkUsable();
    const job = { method, data, options, ...more } as unknown as Job & { method: M };
    const progress = new ProgressListener(onProgress);
    const call = { signal: checkedSignal(signal), progress, transfer: checkedFlag("transfer", transfer) };
    const outcome = await this.#engine.run(job, call);
    const result = outcome.result as Results[M];
    return transfer ? { ...result, input: outcome.data } : result;
  }

  #checkUsable(): void {
    if (this.#isDisposed) throw disposed();
  }
}

/** Options without those that are left undefined; the core checks names and values. */
function checkedOptions<T extends object>(options: T) {
  if (isRecord(options)) return withoutUndefined(options as T);
  throw invalidArgument("options", options, "an object", "Pass { name: value }, or leave it out.");
}

function checkedFlag(name: string, value: unknown): boolean {
  if (typeof value === "boolean") return value;
  throw invalidArgument(`options.${name}`, value, "true or false", "Leave it out for the default.");
}

/** A signal of this realm or another. */
function checkedSignal(signal: unknown): AbortSignal | undefined {
  if (signal === undefined || signal === null) return undefined;
  if (isKind<AbortSignal>(signal, "AbortSignal")) return signal;
  throw invalidArgument("options.signal", signal, "an AbortSignal", "Pass the signal of an AbortController.");
}

function checkedWorkers(workers: unknown = 0): number | "auto" {
  if (workers === "auto" || (Number.isInteger(workers) && (workers as number) >= 0 && (workers as number) <= 64)) {
    return workers as number | "auto";
  }
  const remedy = "Leave it out to work on the calling thread.";
  throw invalidArgument("workers", workers, 'a whole number from 0 to 64, or "auto"', remedy);
}
