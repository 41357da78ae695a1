/// <reference lib="esnext.disposable" preserve="true" />
/** The package's one class. */
import { invalidArgument, Sim3AlignError } from "./error.js";
import { resolveInput } from "./input/resolve.js";
import type { AlignInput } from "./input/types.js";
import { type Core, coreModule, formatsModule, type LoadedModule, type WasmSource } from "./modules.js";
import type { AlignOptions, Defaults, EstimateOptions, EvaluateOptions, Progress, RegisterOptions } from "./options.js";
import { type Alignment, alignmentOf, type Evaluation, type Registration, withWarnings } from "./results.js";
import { coreSim3, type Sim3Like, withTypedMatrix } from "./sim3.js";
import { isRecord, isTypedArray, withoutUndefined, wrongKind } from "./values.js";

/** What `createAligner` can be told. */
export interface AlignerOptions {
  /** Where the core module comes from. By default `wasm/core_bg.wasm` beside this script. */
  wasm?: WasmSource | undefined;
  /** Where the file readers come from, once a file is passed. By default `wasm/formats_bg.wasm` beside this script. */
  formatsWasm?: WasmSource | undefined;
}

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
 * changes its arguments or keeps them.
 */
export class Aligner {
  readonly #core: LoadedModule<Core>;
  readonly #formatsWasm: WasmSource | undefined;
  #isDisposed = false;

  private constructor(core: LoadedModule<Core>, formatsWasm: WasmSource | undefined) {
    this.#core = core;
    this.#formatsWasm = formatsWasm;
  }

  /** @internal */
  static async create({ wasm, formatsWasm }: AlignerOptions): Promise<Aligner> {
    return new Aligner(await coreModule.load(wasm), formatsWasm);
  }

  /**
   * Puts a mesh where a depth map shows it, at its real size: x_cam = s·R·p_mesh + t, OpenCV camera frame (x right, y
   * down, z forward), metres. The same input, options and seed give the same bits.
   *
   * The result says how sure it is (`confidence`), which other poses explain the same picture (`alternatives`), and
   * which parts of the pose the view leaves open (`uncertainty`).
   * @throws {@link Sim3AlignError} for bad input, `INVALID_OPTION` for options that contradict each other, and `NO_CONSENSUS` where nothing that the data support was found
   */
  async align(input: AlignInput, options: AlignOptions = {}): Promise<Alignment> {
    const { onProgress, initial, ...rest } = checkedOptions(options);
    const coreOptions = initial === undefined ? rest : { ...rest, initial: coreSim3(initial) };
    const { core: coreInput, warnings } = await this.#resolve(input);
    const listener = new ProgressListener(onProgress);
    const result = this.#core.call((core) => core.align(coreInput, coreOptions, listener.callback), withoutInput);
    listener.rethrow();
    return withWarnings(alignmentOf(result), warnings);
  }

  /**
   * Scores a transform on an input with the metrics of `align`, and against the truth where `options` has it.
   * @param transform camera from mesh, metres
   * @throws {@link Sim3AlignError} for bad input, `INVALID_TRANSFORM` for what is no similarity
   */
  async evaluate(input: AlignInput, transform: Sim3Like, options: EvaluateOptions = {}): Promise<Evaluation> {
    const { truth, ...rest } = checkedOptions(options);
    const coreOptions = truth === undefined ? rest : { ...rest, truth: coreSim3(truth) };
    const { core: coreInput, warnings } = await this.#resolve(input);
    return withWarnings(
      this.#core.call((core) => core.evaluate(coreInput, coreSim3(transform), coreOptions), withoutInput),
      warnings,
    );
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
    const coreOptions = checkedOptions(options);
    checkCloud("source", source);
    checkCloud("target", target);
    return withTypedMatrix(this.#call((core) => core.register(source, target, coreOptions)));
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
    const coreOptions = checkedOptions(options);
    checkCloud("source", source);
    checkCloud("target", target);
    if (!isTypedArray(correspondences, "Uint32Array")) {
      throw wrongKind("correspondences", correspondences, "a Uint32Array of index pairs", "Uint32Array");
    }
    return withTypedMatrix(this.#call((core) => core.estimateSim3(source, target, correspondences, coreOptions)));
  }

  /** The values that options take where they are left out. */
  async defaults(): Promise<Defaults> {
    return this.#call((core) => core.defaults());
  }

  /** Which build the core is. */
  async buildInfo(): Promise<{ version: string }> {
    return this.#call((core) => ({ version: core.version() }));
  }

  /** Ends the aligner: later calls reject with `DISPOSED`. The modules stay loaded for others. */
  dispose(): void {
    this.#isDisposed = true;
  }

  /** The same, for `using`. */
  [Symbol.dispose](): void {
    this.dispose();
  }

  #call<T>(work: (core: Core) => T): T {
    this.#checkUsable();
    return this.#core.call(work);
  }

  #resolve(input: AlignInput) {
    this.#checkUsable();
    return resolveInput(input, () => formatsModule.load(this.#formatsWasm));
  }

  #checkUsable(): void {
    if (!this.#isDisposed) return;
    throw new Sim3AlignError({
      code: "DISPOSED",
      argument: "aligner",
      found: "an aligner that was disposed of",
      expected: "one in use",
      remedy: "Create a new one with createAligner(), or dispose of it later.",
    });
  }
}

/** Hands progress on, and keeps what the caller's function throws away from the core. */
class ProgressListener {
  readonly callback: ((stage: Progress["stage"], fraction: number) => void) | undefined;
  #failure: { error: unknown } | undefined;

  constructor(onProgress: unknown) {
    if (onProgress === undefined) return;
    if (typeof onProgress !== "function") {
      throw invalidArgument("options.onProgress", onProgress, "a function", "Pass ({ stage, fraction }) => void.");
    }
    this.callback = (stage, fraction) => {
      try {
        if (this.#failure === undefined) onProgress({ stage, fraction } satisfies Progress);
      } catch (error) {
        this.#failure = { error };
      }
    };
  }

  /** Throws what the caller's function threw first, if it did. */
  rethrow(): void {
    if (this.#failure !== undefined) throw this.#failure.error;
  }
}

/** Properties of the input are named without it. */
const withoutInput = (argument: string) => argument.replace(/^input\./, "");

/** Options without those that are left undefined; the core checks names and values. */
function checkedOptions<T extends object>(options: T) {
  if (isRecord(options)) return withoutUndefined(options as T);
  throw invalidArgument("options", options, "an object", "Pass { name: value }, or leave it out.");
}

function checkCloud(argument: string, cloud: unknown): void {
  if (isTypedArray(cloud, "Float32Array", "Float64Array")) return;
  throw wrongKind(argument, cloud, "a Float32Array or a Float64Array, x, y, z per point", "Float64Array");
}
