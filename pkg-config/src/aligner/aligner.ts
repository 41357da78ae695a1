/// <reference lib="esnext.disposable" preserve="true" />
/** The main class of the package. */

import { cachesMesh, type DataOf, type Method, type ResultOf, type SettingsOf } from "../calls/calls.js";
import { type Call, type Engine, MainThreadEngine, signalsOf } from "../calls/engine.js";
import { checkedListener, ProgressListener } from "../calls/progress.js";
import { checkSignals, reasonOf } from "../concurrency/on-abort.js";
import { Queue } from "../concurrency/queue.js";
import type { Preset } from "../generated/types.js";
import { coreSim3, type Sim3Like } from "../input/sim3.js";
import type { Core, ModuleName } from "../modules/exports.js";
import { type LoadedModule, type Modules, modulesBy } from "../modules/module.js";
import { checkedModules, wasmModules } from "../modules/modules.js";
import { WorkerPool } from "../pool/pool.js";
import { workerFactory } from "../pool/port.js";
import type { AlignInput, MeshInput, ViewsInput } from "../types/inputs.js";
import type {
  AlignAllOptions,
  CallOptions,
  EstimateSim3Options,
  EvaluateOptions,
  OptionsOf,
  Progress,
  RegisterOptions,
  TrackOptions,
  ViewsOptions,
} from "../types/options.js";
import type { AlignAllResult, AlignResult, Evaluation, Registration, ViewsAlignment } from "../types/results.js";
import type { SceneInput, SceneOptions, SceneResult } from "../types/scene.js";
import { checkAttached, plainArgument } from "../values/border.js";
import { disposed, failure, internalError, Sim3AlignError, withStackOf } from "../values/error.js";
import { isRecord } from "../values/kinds.js";
import { nextMeshId, PreparedMesh, withArrays } from "../values/prepared-mesh.js";
import { copied } from "../values/transfer.js";
import { withoutUndefined } from "../values/validation.js";
import { alignAll } from "./align-all.js";
import {
  type AlignerOptions,
  autoWorkers,
  type BundledAssets,
  checkedAlignerOptions,
  checkedFactory,
  checkedFlag,
  checkedOptions,
  checkedSignal,
  checkedStartMs,
  checkedWorkers,
} from "./aligner-options.js";
import { type OwnEngine, Tracker, type TrackerMesh } from "./tracker.js";

/**
 * Loads the core module and creates an aligner. The module is loaded once and shared by all aligners; only the `wasm`
 * of the first call is used. Each aligner has its own state.
 * @throws {@link Sim3AlignError} `NOT_INITIALISED` if the module cannot be loaded; the next call tries again
 */
export async function createAligner(options: AlignerOptions = {}): Promise<Aligner> {
  return Aligner.create(options);
}

/**
 * Estimates similarity transforms. Methods reject with {@link Sim3AlignError}; the aligner remains usable. They neither
 * modify nor retain their arguments. With workers, arguments are copied when a worker is free: do not modify them
 * before the call settles.
 */
export class Aligner {
  readonly #core: LoadedModule<Core>;
  readonly #modules: Modules;
  readonly #engine: Engine;
  /** Limits the scenes at a time to the number of jobs of the engine. */
  readonly #scenes: Queue<number>;
  #isDisposed = false;

  /** Creates an engine for one tracker. */
  readonly #dedicated: () => OwnEngine;
  readonly #trackers = new Set<Tracker>();

  private constructor(core: LoadedModule<Core>, modules: Modules, engine: Engine, dedicated: () => OwnEngine) {
    this.#core = core;
    this.#modules = modules;
    this.#engine = engine;
    this.#scenes = new Queue(Array.from({ length: engine.capacity }, (_, i) => i));
    this.#dedicated = dedicated;
  }

  /** @internal */
  static async create(options: AlignerOptions, assets: BundledAssets = {}): Promise<Aligner> {
    const given = checkedAlignerOptions(options);
    const wasm = { ...assets.wasm, ...withoutUndefined(checkedModules(given.wasm)) };
    const workers = checkedWorkers(given.workers);
    const startMs = checkedStartMs(given.workerStartMs);
    const modules = modulesBy((name) => wasmModules[name].load(wasm[name]));
    const core = await modules.core();
    if (workers === 0) {
      const engine = new MainThreadEngine(wasmModules, modules);
      // Shared with all other calls on this thread, which the end of a tracker must not end.
      return new Aligner(core, modules, engine, () => ({ engine, isShared: true }));
    }
    const factory = await workerFactory(assets.workerScript, checkedFactory(given.createWorker));
    const size = workers === "auto" ? autoWorkers(factory.cores) : workers;
    const compiled = (name: ModuleName) => wasmModules[name].compile(wasm[name]);
    const setup = { create: factory.create, startMs, compiled };
    // A pool disposes its engine of the main thread: each has one of its own.
    const pool = (size: number) => new WorkerPool(size, setup, new MainThreadEngine(wasmModules, modules));
    return new Aligner(core, modules, pool(size), () => ({ engine: pool(1), isShared: false }));
  }

  /**
   * Aligns a mesh to the object in a depth map: x_cam = s·R·p_mesh + t, OpenCV camera frame (x right, y down, z
   * forward), metres. The same input, options and seed give bit-identical results with any number of workers.
   *
   * The result includes a calibrated probability (`confidence`), other poses that explain the observation almost as
   * well (`alternatives`), and the uncertainty of each part of the pose (`uncertainty`). With `preset: "paper"` it has
   * none of these; with `metrics: false` it has no `metrics`.
   * @example
   * ```ts
   * const { matrix, scale, confidence } = await aligner.align({ depth, width, height, mask, camera: { fx, fy, cx, cy }, mesh });
   * object3d.matrix.fromArray(matrix); // column-major, in the camera frame of OpenCV
   * ```
   * @throws {@link Sim3AlignError} for invalid input, `INVALID_OPTION` for contradictory options, `UNKNOWN_OPTION` for
   * options of the other preset, and `NO_CONSENSUS` if no pose is supported by the data
   */
  async align<P extends Preset = "precise", M extends boolean = true>(
    input: AlignInput,
    options?: OptionsOf<P, M>,
  ): Promise<AlignResult<P, M>> {
    return this.#align<P, M>(input, options, false);
  }

  /**
   * Aligns many inputs, and yields each result when it is ready: `{ index, alignment }`, or `{ index, error }` if an
   * input is invalid; the other inputs continue. Inputs are pulled on demand: at most twice the number of workers (one,
   * without workers) are in memory at a time. Leaving the loop cancels the running alignments. Other calls go before the inputs
   * that wait for a worker.
   * @example
   * ```ts
   * for await (const { index, alignment, error } of aligner.alignAll(inputs)) console.log(index, alignment ?? error);
   * ```
   * @throws the exceptions of `inputs`, the reason of an aborted signal, and {@link Sim3AlignError} `DISPOSED`
   */
  async *alignAll<P extends Preset = "precise", M extends boolean = true>(
    inputs: Iterable<AlignInput> | AsyncIterable<AlignInput>,
    options?: AlignAllOptions<P, M>,
  ): AsyncGenerator<AlignAllResult<AlignResult<P, M>>, void, undefined> {
    this.#checkUsable();
    const given = checkedOptions(options) as AlignAllOptions<Preset>;
    const { ordered = false, onProgress, signal, ...rest } = given;
    if (onProgress !== undefined) checkedListener(onProgress);
    yield* alignAll(inputs, {
      limit: this.#engine.capacity,
      ordered: checkedFlag("ordered", ordered),
      signal: checkedSignal(signal),
      align: (input, index, signal) => {
        const own = onProgress && { onProgress: (progress: Progress) => onProgress({ ...progress, index }) };
        return this.#align<P, M>(input, { ...rest, ...own, signal } as OptionsOf<P, M>, true);
      },
      isOwn: (error): error is Sim3AlignError => error instanceof Sim3AlignError && error.code !== "DISPOSED",
    });
  }

  /**
   * Aligns the objects of a scene: one depth map, a mask and a mesh per object. Each is first aligned alone, as by
   * `align`; then jointly, with mutual occlusion, shared volume and the support plane. Contact is evidence, not
   * a rule: what hangs, leans or lies on something else stays so.
   * Poses, frames and units are those of `align`; `contact` of each object says what it rests on.
   *
   * In workers, objects are aligned side by side; the result has the same bits for any number of workers. There is no
   * `transfer`: all objects need the depth map.
   * @example
   * ```ts
   * const { objects, support } = await aligner.alignScene({ depth, camera, objects: [{ name, mask, mesh }] });
   * ```
   * @throws {@link Sim3AlignError} for an invalid view, mask or option. An object that cannot be aligned has an `error`
   * in its place of the result
   */
  async alignScene(scene: SceneInput, options?: SceneOptions): Promise<SceneResult> {
    this.#checkUsable();
    const given: CallOptions & Record<string, unknown> = checkedOptions(options ?? {});
    const { signal, onProgress, snap = false, ...rest } = given;
    for (const [name, remedy] of Object.entries(notOfScenes)) {
      if (rest[name] === undefined) continue;
      throw failure("UNKNOWN_OPTION", `options.${name}`, "an option of align", "options of alignScene", remedy);
    }
    const own = plainArgument("input", scene);
    const call = { signal: checkedSignal(signal), progress: new ProgressListener(onProgress), transfer: false };
    const settings = { options: rest, snap: checkedFlag("snap", snap) };
    return guarded(call, () => {
      checkSignals(signalsOf(call));
      return this.#inTurn(call, async () => {
        // Most calls align one object.
        const { alignScene } = await import("../scene/align-scene.js");
        return alignScene(own, this.#modules, this.#engine, settings, call);
      });
    });
  }

  /**
   * Aligns a mesh with several views of the same object.
   *
   * With the poses of all cameras (`cameraToWorld`), there is one search over the evidence of all views: the result is the
   * pose in the world, and in each camera. A view may lack a mask, and one that contradicts the others, or whose mask cannot
   * be used, is left out (`role`). Without camera poses, the views have one size in common and a pose each; the world is then the camera of
   * the first view that agrees with that size, and `views[i].camera` the pose of each camera that follows from it.
   * @example
   * ```ts
   * const { matrix, scale, views } = await aligner.alignViews({ // matrix: world from mesh
   *   mesh,
   *   views: [
   *     { depth: depths[0], mask: masks[0], camera, cameraToWorld: poses[0] },
   *     { depth: depths[1], mask: masks[1], camera, cameraToWorld: poses[1] },
   *   ],
   * });
   * ```
   * @throws {@link Sim3AlignError} for invalid input, whose argument names the view (`views[1].depth`), and
   * `NO_CONSENSUS` if no pose is supported by the data
   */
  async alignViews(input: ViewsInput, options?: ViewsOptions): Promise<ViewsAlignment> {
    const { onProgress, ...rest }: { onProgress?: unknown } = checkedOptions(options);
    return this.#run("alignViews", input, rest, (core) => core, { onProgress });
  }

  /**
   * Opens a tracker, which follows the object of a mesh through the frames of a video. With workers, it has a worker of
   * its own, until it is disposed.
   * @example
   * ```ts
   * const tracker = await aligner.track(mesh);
   * for await (const { depth, mask } of frames) {
   *   const { state, matrix } = await tracker.next({ depth, mask, camera });
   *   if (state === "tracking") show(matrix);
   * }
   * tracker.dispose();
   * ```
   * @throws {@link Sim3AlignError} for an invalid mesh or invalid options
   */
  async track(mesh: MeshInput, options?: TrackOptions): Promise<Tracker> {
    const { signal, initial, ...rest }: { signal?: unknown; initial?: unknown } = checkedOptions(options);
    const coreOptions = initial === undefined ? rest : { ...rest, initial: coreSim3(initial as Sim3Like) };
    const listened = checkedSignal(signal);
    this.#checkUsable();
    const { release, ...own } = withArrays(plainArgument("input", { mesh }), this.#engine);
    const onDispose = (tracker: Tracker) => this.#trackers.delete(tracker);
    const opening = Tracker.open(this.#dedicated(), own as TrackerMesh, coreOptions, listened, onDispose);
    const tracker = await opening.finally(release);
    if (this.#isDisposed) tracker.dispose();
    this.#checkUsable();
    this.#trackers.add(tracker);
    return tracker;
  }

  /**
   * Computes the metrics of a transform and, if `options.truth` is given, its errors.
   * @example
   * ```ts
   * const { metrics, errors } = await aligner.evaluate({ depth, mask, camera, mesh }, pose, { truth });
   * console.log(metrics.iou, errors?.rotationErrorDeg);
   * ```
   * @param transform camera from mesh, metres
   * @throws {@link Sim3AlignError} for invalid input, `INVALID_TRANSFORM` if the transform is not a similarity
   */
  async evaluate(input: AlignInput, transform: Sim3Like, options: EvaluateOptions = {}): Promise<Evaluation> {
    const { truth, ...rest } = checkedOptions(options);
    const coreOptions = truth === undefined ? rest : { ...rest, truth: coreSim3(truth) };
    const pose = coreSim3(plainArgument("transform", transform));
    return this.#run("evaluate", input, coreOptions, (settings) => ({ transform: pose, settings }));
  }

  /**
   * Aligns a point cloud with another that overlaps it at least partially: y = s·R·x + t.
   * Points with NaN or infinite coordinates, as organised clouds of depth cameras have them, are skipped and counted in
   * `diagnostics`.
   * @example
   * ```ts
   * const { scale, matrix } = await aligner.register(scan, model, { scale: [0.5, 2] });
   * ```
   * @param source interleaved x, y, z, in any unit
   * @param target interleaved x, y, z, in any unit
   * @throws {@link Sim3AlignError} for invalid input, and `NO_CONSENSUS` if no transform is supported by the data. A free
   * scale is searched from a fifth to five times the ratio of the bounding boxes; pass bounds for another range.
   */
  async register(
    source: Float32Array | Float64Array,
    target: Float32Array | Float64Array,
    options: RegisterOptions = {},
  ): Promise<Registration> {
    return this.#run("register", { source, target }, checkedOptions(options), (core) => core);
  }

  /**
   * Estimates the transform that most correspondences agree with: y = s·R·x + t.
   * @param source interleaved x, y, z, in any unit
   * @param target interleaved x, y, z, in any unit
   * @param correspondences interleaved pairs: index of a source point, index of its target point
   * @throws {@link Sim3AlignError} for invalid input, and `NO_CONSENSUS` if too few correspondences agree
   */
  async estimateSim3(
    source: Float32Array | Float64Array,
    target: Float32Array | Float64Array,
    correspondences: Uint32Array,
    options: EstimateSim3Options = {},
  ): Promise<Registration> {
    const data = { source, target, correspondences };
    return this.#run("estimateSim3", data, checkedOptions(options), (core) => core);
  }

  /**
   * Reads, validates and decimates a mesh once for many calls: frames of a video, several views, or several instances
   * of the object. Pass the result as `mesh`.
   * @example
   * ```ts
   * const mesh = await aligner.prepareMesh(glbBytes);
   * const results = await Promise.all(frames.map((frame) => aligner.align({ ...frame, mesh })));
   * mesh.dispose();
   * ```
   * @throws {@link Sim3AlignError} for an invalid mesh, `DEGENERATE_MESH` for a mesh without volume
   */
  async prepareMesh(mesh: MeshInput, options: Pick<CallOptions, "signal"> = {}): Promise<PreparedMesh> {
    const id = nextMeshId();
    try {
      const { mesh: read, ...notes } = await this.#run(
        "prepareMesh",
        { mesh },
        checkedOptions(options),
        (core) => core,
        { meshId: id },
      );
      // Without workers, these are the caller's arrays.
      checkAttached("mesh", read);
      return new PreparedMesh({ id, mesh: { ...copied(read), ...notes } }, this.#engine);
    } catch (error) {
      // Nothing refers to what the call has left there.
      this.#engine.dropMesh(id);
      throw error;
    }
  }

  /** The version of the core module. */
  get version(): string {
    return this.#core.call((core) => core.version());
  }

  /**
   * Releases the aligner and terminates its workers. Running and later calls reject with `DISPOSED`. The modules stay
   * loaded for other aligners.
   */
  dispose(): void {
    if (this.#isDisposed) return;
    this.#isDisposed = true;
    for (const tracker of this.#trackers) tracker.dispose();
    this.#engine.dispose();
  }

  /** Disposes the aligner at the end of the scope of a `using` declaration. */
  [Symbol.dispose](): void {
    this.dispose();
  }

  async #align<P extends Preset, M extends boolean>(
    input: AlignInput,
    options: OptionsOf<P, M> | undefined,
    isBatched: boolean,
  ): Promise<AlignResult<P, M>> {
    const given: CallOptions & { initial?: unknown; onProgress?: unknown; preset?: unknown } = checkedOptions(options);
    const { initial, onProgress, ...rest } = given;
    const coreOptions = initial === undefined ? rest : { ...rest, initial: coreSim3(initial) };
    const method = rest.preset === "paper" ? "alignPaper" : "align";
    const result = await this.#run(method, input, coreOptions, (core) => core, { onProgress, isBatched });
    return result as AlignResult<P, M>;
  }

  /** @param settings the options of the core in the form of the job */
  async #run<M extends Method>(
    method: M,
    data: DataOf<M>,
    { signal, transfer = false, ...options }: CallOptions,
    settings: (options: object) => SettingsOf<M>,
    { onProgress, meshId, isBatched = false }: { onProgress?: unknown; meshId?: number; isBatched?: boolean } = {},
  ): Promise<ResultOf<M>> {
    this.#checkUsable();
    const own = plainArgument("input", data);
    const { release, restored, ...sent } = withArrays(own, this.#engine, cachesMesh(method, own));
    const job = { method, options: settings(options), ...(meshId === undefined ? sent : { ...sent, meshId }) };
    const progress = new ProgressListener(onProgress);
    const call = { signal: checkedSignal(signal), progress, transfer: checkedFlag("transfer", transfer), isBatched };
    // Arrays that were not moved are returned in the object that the caller passed; a prepared mesh replaces its arrays.
    const returned = (arrays: DataOf<M>) => (arrays === job.data ? data : restored(arrays));
    try {
      const outcome = await guarded(call, () => this.#engine.run(job, call));
      return transfer ? { ...outcome.result, input: returned(outcome.data) } : outcome.result;
    } catch (error) {
      if (call.transfer && error instanceof Sim3AlignError && isRecord(error.input))
        error.input = returned(error.input as DataOf<M>);
      throw error;
    } finally {
      release();
    }
  }

  /** Runs a scene when those before it have ended: each holds its images until its end. */
  async #inTurn<T>(call: Call, run: () => Promise<T>): Promise<T> {
    const turn = await this.#scenes.acquire(signalsOf(call));
    try {
      this.#checkUsable();
      return await run();
    } finally {
      this.#scenes.release(turn);
    }
  }

  #checkUsable(): void {
    if (this.#isDisposed) throw disposed();
  }
}

/** Options of `align` that those of `alignScene` lack, and what to do instead. */
const notOfScenes = {
  initial: "Pass it as `initial` of an object.",
  transfer: "Omit it: all objects need the depth map, which therefore stays with the caller.",
};

/** Runs a call, which rejects with a {@link Sim3AlignError}, the reason of its signal, or the exception of `onProgress`. */
async function guarded<T>({ signal, progress }: Call, run: () => Promise<T>): Promise<T> {
  const begin = new Error();
  try {
    const result = await run();
    checkSignals([progress.failed]);
    return result;
  } catch (error) {
    if (signal?.aborted && reasonOf(signal) === error) throw error;
    // It came first: the error may be that of the last piece of work.
    checkSignals([progress.failed]);
    throw withStackOf(error instanceof Sim3AlignError ? error : internalError(error), begin);
  }
}
