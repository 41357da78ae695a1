/** Calls as data, so that the same code runs them on the calling thread or in a worker. */
import { checkAttached } from "./attached.js";
import type { Core, CoreListener, Task } from "./core.js";
import { withoutInput } from "./error.js";
import type { FileReaders } from "./file-readers.js";
import type { CorrectedFrame } from "./generated/types.js";
import type { FrameInput, ViewsInput } from "./input/frame-types.js";
import { resolveFrame, resolveViews } from "./input/frames.js";
import { type MeshAndWarnings, readCoreMesh, readMesh } from "./input/mesh.js";
import { resolveInput } from "./input/resolve.js";
import type { AlignInput, MeshInput } from "./input/types.js";
import type { JointAligner, LoadJoint, Placed } from "./joint-module.js";
import type { LoadRegistrar, Registrar } from "./registration-module.js";
import {
  type AlignResult,
  type Clouds,
  type Evaluation,
  type FileWarnings,
  type Registration,
  type TrackedFrame,
  type ViewsAlignment,
  withWarnings,
} from "./results.js";
import { isTypedArray, wrongKind } from "./values.js";
import type { Glue, LoadedModule } from "./wasm-module.js";

/** The calls: their data, which contain all large arrays, what else they are given, and their results. */
interface Calls {
  align: { data: AlignInput; meshId?: number | undefined; result: AlignResult };
  place: { data: PlaceInput; meshId?: number | undefined; result: Placed };
  alignViews: { data: ViewsInput; meshId?: number | undefined; result: ViewsAlignment };
  openTracker: { data: { mesh: MeshInput }; tracker: number; meshId?: number | undefined; result: undefined };
  trackFrame: { data: FrameInput; tracker: number; result: TrackedFrame };
  correctTrack: { data: { pose: unknown; frame: unknown }; tracker: number; result: CorrectedFrame[] };
  evaluate: { data: AlignInput; transform: unknown; meshId?: number | undefined; result: Evaluation };
  prepareMesh: { data: { mesh: MeshInput }; meshId: number; result: MeshAndWarnings };
  register: { data: Clouds; result: Registration };
  estimateSim3: { data: Clouds; result: Registration };
}

type JobOf<M extends keyof Calls> = { method: M; options: object } & Omit<Calls[M], "result">;

/** A call as data; `options` are in the form of the core. */
export type Job = { [M in keyof Calls]: JobOf<M> }[keyof Calls];

/** The result of each call. */
export type Results = { [M in keyof Calls]: Calls[M]["result"] };

/** An object of a scene, the pixels of the others, and the plan of the scene, which only the joint module reads. */
export type PlaceInput = AlignInput & { others?: Uint8Array | undefined; plan?: Uint8Array | undefined; index: number };

/** The modules that run jobs. Others than the core are loaded when a job needs them. */
export interface Modules extends FileReaders {
  core: LoadedModule<Core>;
  registrar: LoadRegistrar;
  joint: LoadJoint;
}

/** The modules that cache prepared meshes, each its own copy. */
export type MeshCache = "core" | "joint";

/** The module that caches the prepared mesh of a job. */
export const meshCacheOf = ({ method }: Job): MeshCache =>
  method === "place" || method === "alignViews" || method === "openTracker" ? "joint" : "core";

/** Whether these are options of `align` for the method of the paper, which the registration module runs. */
export const isOfPaper = (options: { preset?: unknown }): boolean => options.preset === "paper";

/**
 * Runs a job. `listener` is called when stages begin; if it throws, the job fails with that exception.
 * @param slices how tasks run; at once by default
 */
export async function perform<J extends Job>(
  job: J,
  modules: Modules,
  listener: CoreListener | undefined,
  slices?: Slices,
): Promise<Results[J["method"]]>;
export async function perform(
  job: Job,
  modules: Modules,
  listener: CoreListener | undefined,
  slices: Slices = all,
): Promise<unknown> {
  const { core, formats, registrar, joint } = modules;
  const { options } = job;
  checkAttached("input", job.data);
  switch (job.method) {
    case "align": {
      const { core: input, warnings } = await resolveInput(job.data, modules, job.meshId);
      const result = isOfPaper(options)
        ? called(await registrar(), (r) => r.alignPaper(input, options, listener), input)
        : await runTask(core, (c) => c.beginAlign(input, options, listener), input, slices);
      return withWarnings(result, warnings);
    }
    case "place": {
      const { others, plan, index, ...own } = job.data;
      const { core: input, warnings } = await resolveInput(own, modules, job.meshId);
      const observed = { ...input, others };
      const begin = (j: JointAligner) => j.beginPlace(observed, options, plan, index, listener);
      const placed = await runTask(await joint(), begin, observed, slices);
      if (placed.alignment === undefined) return placed;
      // The camera belongs to the scene, which reports its warnings.
      return { ...placed, alignment: withWarnings(placed.alignment, { camera: [], colors: warnings.colors }) };
    }
    case "alignViews": {
      const { core: input, warnings } = await resolveViews(job.data, modules, job.meshId);
      const begin = (j: JointAligner) => j.beginAlignViews(input, options, listener);
      const result = await runTask(await joint(), begin, input, slices);
      return {
        ...result,
        views: result.views.map((view, k) => withWarnings(view, warnings[k] as FileWarnings)),
      };
    }
    case "openTracker": {
      // Any frame may have a photo.
      const { mesh } = await readCoreMesh(job.data.mesh, formats, true, job.meshId);
      const module = await joint();
      checkAttached("mesh", mesh);
      module.call((j) => {
        j.openTracker(job.tracker, { mesh }, options);
        module.keep(trackerName(job.tracker));
      });
      return undefined;
    }
    case "trackFrame": {
      const { core: frame } = await resolveFrame(job.data, modules);
      const module = await joint();
      checkAttached("frame", frame);
      return module.call((j) => j.trackFrame(job.tracker, frame, listener));
    }
    case "correctTrack": {
      const { pose, frame } = job.data;
      return (await joint()).call((j) => j.correctTrack(job.tracker, pose, frame));
    }
    case "evaluate": {
      const { core: input, warnings } = await resolveInput(job.data, modules, job.meshId);
      const evaluation = called(core, (c) => c.evaluate(input, job.transform, options), input);
      return withWarnings(evaluation, warnings);
    }
    case "prepareMesh": {
      const { mesh, warnings } = await readMesh(job.data.mesh, formats, true);
      checkAttached("mesh", mesh);
      core.call((c) => c.prepareMesh({ ...mesh, id: job.meshId }));
      return { mesh, warnings };
    }
    case "register": {
      const { source, target } = checkedClouds(job.data);
      return runTask(await registrar(), (r) => r.beginRegister(source, target, options), job.data, slices);
    }
    case "estimateSim3": {
      const { source, target, correspondences } = checkedClouds(job.data);
      if (!isTypedArray<Uint32Array>(correspondences, "Uint32Array")) {
        throw wrongKind("correspondences", correspondences, "a Uint32Array of index pairs", "Uint32Array");
      }
      const begin = (r: Registrar) => r.beginEstimateSim3(source, target, correspondences, options);
      return runTask(await registrar(), begin, job.data, slices);
    }
  }
}

/** Calls a module with an input that has been read. Meanwhile, the thread may have lost its memory to another one. */
function called<G extends Glue, T>(module: LoadedModule<G>, work: (glue: G) => T, input: object): T {
  checkAttached("input", input);
  return module.call(work, withoutInput);
}

/** How a task runs. */
export interface Slices {
  /** About how long each slice takes. */
  sliceMs: number;
  /** Called after each slice and each turn; may throw. */
  check(): void;
  /** Gives the thread away between two slices. */
  turn(): Promise<void>;
}

const all: Slices = { sliceMs: Number.POSITIVE_INFINITY, check() {}, async turn() {} };

/** What a tracker is called where its module keeps it. */
export const trackerName = (id: number) => `tracker ${id}`;

/** Runs a task to its end, and frees it. `input` is what its beginning reads. */
async function runTask<G extends Glue, T>(
  module: LoadedModule<G>,
  begin: (glue: G) => Task<T>,
  input: object,
  slices: Slices,
): Promise<T> {
  const { sliceMs, check, turn } = slices;
  // The thread may have been elsewhere since the input was read.
  checkAttached("input", input);
  check();
  const task = module.call((glue) => {
    const begun = begin(glue);
    module.keep(begun);
    return begun;
  }, withoutInput);
  const { instance } = module;
  try {
    for (;;) {
      const result = module.call(() => task.step(sliceMs), withoutInput);
      check();
      if (result !== undefined) return result;
      await turn();
      check();
      // Another call trapped, and the task was lost with its instance.
      if (module.instance !== instance) return await runTask(module, begin, input, slices);
    }
  } finally {
    if (module.instance === instance) task.free();
    module.drop(task);
  }
}

function checkedClouds(clouds: Clouds): Clouds {
  for (const argument of ["source", "target"] as const) {
    const cloud: unknown = clouds[argument];
    if (isTypedArray(cloud, "Float32Array", "Float64Array")) continue;
    throw wrongKind(argument, cloud, "a Float32Array or a Float64Array, x, y, z per point", "Float64Array");
  }
  return clouds;
}
