/** Calls as data, so that the same code runs them on the calling thread or in a worker. */
import { checkAttached } from "./attached.js";
import {
  type Calibrated,
  type CalibrationObject,
  checkMeasurable,
  inCalibration,
  isRaw,
  partsOf,
} from "./calibrate.js";
import type { Core, CoreHelpers, CoreListener, Helper, Task } from "./core.js";
import { isOfInput, withoutInput } from "./error.js";
import type { FileReaders } from "./file-readers.js";
import type { CorrectedFrame } from "./generated/types.js";
import type { CoreInput, CoreView, CoreViews } from "./input/core-input.js";
import type { FrameInput, ViewsInput } from "./input/frame-types.js";
import { resolveFrame, resolveViews } from "./input/frames.js";
import { type MeshAndWarnings, readCoreMesh, readMesh } from "./input/mesh.js";
import { resolveInput } from "./input/resolve.js";
import type { AlignInput, MeshInput } from "./input/types.js";
import type { JointAligner, LoadJoint, Placed } from "./joint-module.js";
import type { CoreMesh } from "./prepared-mesh.js";
import type { LoadRegistrar, Registrar } from "./registration-module.js";
import {
  type AlignResult,
  type Evaluation,
  type InputNotes,
  type Registration,
  sourcesOf,
  type TrackedFrame,
  type ViewAlignment,
  type ViewsAlignment,
  withNotes,
} from "./results.js";
import { isTypedArray, withoutUndefined, wrongKind } from "./values.js";
import type { Glue, LoadedModule } from "./wasm-module.js";

/** The calls: their data, which contain all large arrays, what else they are given, and their results. */
interface Calls {
  align: { data: AlignInput; meshId?: number | undefined; result: AlignResult };
  calibrate: { data: CalibrateInput; result: Calibrated };
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

/**
 * An object of a scene, the pixels of the others, the plan of the scene, which only the joint module reads, and the
 * uncertainty of its calibration.
 */
export type PlaceInput = AlignInput & {
  others?: Uint8Array | undefined;
  plan?: Uint8Array | undefined;
  index: number;
  uncertainty?: object | undefined;
};

/** A view in the form of the core, and the objects by which it is calibrated, whose meshes have not been read. */
export type CalibrateInput = CoreView & { objects: (Omit<CalibrationObject, "mesh"> & { mesh: unknown })[] };

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
  const { core, registrar, joint } = modules;
  const { options } = job;
  checkAttached("input", job.data);
  switch (job.method) {
    case "align": {
      const { core: read, notes } = await resolveInput(job.data, modules, job.meshId);
      const [first, then] = isRaw(read) ? partsOf(listener) : [undefined, listener];
      const calibrated = isRaw(read) ? await calibrateByObject(read, options, await joint(), first, slices) : undefined;
      const input = calibrated === undefined ? read : inCalibration(read, calibrated);
      const result = isOfPaper(options)
        ? called(await registrar(), (r) => r.alignPaper(input, options, then), input)
        : await runTask(
            core,
            (c) => c.beginAlign(input, options, then, helpersOf(slices, { input, options })),
            input,
            slices,
          );
      return withNotes(calibratedResult(result, calibrated), notes);
    }
    case "calibrate": {
      const { objects, ...view } = job.data;
      const read: CalibrationObject[] = [];
      for (const object of objects) {
        // What is wrong with a mesh is told where it is aligned.
        const mesh = await readCoreMesh(object.mesh, modules, false).catch((error) => {
          if (!isOfInput(error)) throw error;
        });
        if (mesh) read.push({ ...object, mesh: mesh.mesh });
      }
      const input = { ...view, objects: read };
      return runTask(await joint(), (j) => j.beginCalibrate(input, listener), input, slices);
    }
    case "place": {
      const { others, plan, index, uncertainty, ...own } = job.data;
      const { core: input, notes } = await resolveInput(own, modules, job.meshId);
      const observed = { ...input, others, uncertainty };
      const helpers = helpersOf(slices, { input: observed, options, placed: { plan, index } });
      const begin = (j: JointAligner) => j.beginPlace(observed, options, plan, index, listener, helpers);
      const placed = await runTask(await joint(), begin, observed, slices);
      if (placed.alignment === undefined) return placed;
      // The view belongs to the scene, which reports what its files say.
      return { ...placed, alignment: withNotes(placed.alignment, { warnings: [], colors: notes.colors }) };
    }
    case "alignViews": {
      const { core: read, notes } = await resolveViews(job.data, modules, job.meshId);
      const module = await joint();
      const [first, then] = read.views.some(isRaw) ? partsOf(listener) : [undefined, listener];
      const beginFirst = (j: JointAligner) => j.beginCalibrateViews({ ...read, options }, first);
      const calibrated = read.views.some(isRaw) ? await runTask(module, beginFirst, read, slices) : [];
      const views = read.views.map((view, k) => {
        const own = calibrated[k];
        return own === undefined ? view : inCalibration(view, own);
      });
      const input = { ...read, views };
      const helpers = helpersOf(slices, { input, options });
      const result = await runTask(module, (j) => j.beginAlignViews(input, options, then, helpers), input, slices);
      const ofView = (view: ViewAlignment, k: number) =>
        withNotes(calibratedResult(view, calibrated[k]), notes[k] as InputNotes);
      return { ...result, views: result.views.map(ofView) };
    }
    case "openTracker": {
      // Any frame may have a photo.
      const { mesh } = await readCoreMesh(job.data.mesh, modules, true, job.meshId);
      const module = await joint();
      checkAttached("mesh", mesh);
      module.call((j) => {
        j.openTracker(job.tracker, { mesh }, options);
        module.keep(trackerName(job.tracker));
      });
      return undefined;
    }
    case "trackFrame": {
      const { core: frame, notes } = await resolveFrame(job.data, modules);
      const module = await joint();
      checkAttached("frame", frame);
      return { ...module.call((j) => j.trackFrame(job.tracker, frame, listener)), ...sourcesOf(notes) };
    }
    case "correctTrack": {
      const { pose, frame } = job.data;
      return (await joint()).call((j) => j.correctTrack(job.tracker, pose, frame));
    }
    case "evaluate": {
      const { core: input, notes } = await resolveInput(job.data, modules, job.meshId);
      checkMeasurable(input);
      const evaluation = called(core, (c) => c.evaluate(input, job.transform, options), input);
      return withNotes(evaluation, notes);
    }
    case "prepareMesh": {
      const { mesh, warnings } = await readMesh(job.data.mesh, modules, true);
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

/** Calibrates the view of an input by its object. */
function calibrateByObject(
  { mesh, mask, maskWidth, maskHeight, resizeMask, ...view }: CoreInput,
  options: object,
  joint: LoadedModule<JointAligner>,
  listener: CoreListener | undefined,
  slices: Slices,
): Promise<Calibrated> {
  const { id: _, ...own } = mesh;
  // What is known of the object is an option of one method.
  const known = isOfPaper(options) ? {} : options;
  const object = withoutUndefined({ mask, maskWidth, maskHeight, resizeMask, mesh: own, options: known });
  const input = { ...view, objects: [object as CalibrationObject] };
  return runTask(joint, (j) => j.beginCalibrate(input, listener), input, slices);
}

const calibratedResult = <T extends object>(result: T, calibrated: Calibrated | undefined): T =>
  calibrated === undefined ? result : { ...result, depthCalibration: calibrated.calibration };

/** Calls a module with an input that has been read. Meanwhile, the thread may have lost its memory to another one. */
function called<G extends Glue, T>(module: LoadedModule<G>, work: (glue: G) => T, input: object): T {
  checkAttached("input", input);
  return module.call(work, withoutInput);
}

/** The input of a task, for those that help with it. */
export interface Offer {
  input: CoreInput | CoreViews;
  options: object;
  /** For an object of a scene: what is known of the others. */
  placed?: { plan: Uint8Array | undefined; index: number };
}

/** How a task runs. */
export interface Slices {
  /** The helpers of a task with this input. */
  helpersFor?(offer: Offer): CoreHelpers;
  /** About how long each slice takes. */
  sliceMs: number;
  /** Called after each slice and each turn; may throw. */
  check(): void;
  /** Gives the thread away between two slices. */
  turn(): Promise<void>;
}

const all: Slices = { sliceMs: Number.POSITIVE_INFINITY, check() {}, async turn() {} };

/** The helpers of a task, if it may have some. A prepared mesh comes to them from where it was prepared. */
function helpersOf(slices: Slices, { input, ...offer }: Offer): CoreHelpers | undefined {
  const { id } = input.mesh;
  const mesh = id === undefined ? input.mesh : { positions: new Float32Array(), id };
  return slices.helpersFor?.({ ...offer, input: { ...input, mesh } });
}

/**
 * Prepares help with a task.
 * @param mesh the arrays of its prepared mesh, unless the module has them
 */
export async function beginHelp(
  { input, options, placed }: Offer,
  mesh: CoreMesh | undefined,
  { core, joint }: Modules,
): Promise<{ module: LoadedModule<Glue>; helper: Helper }> {
  const { id } = input.mesh;
  const ownMesh = mesh === undefined || id === undefined ? input.mesh : { ...mesh, id };
  const kept = <G extends Glue>(module: LoadedModule<G>, begin: (glue: G) => Helper) => {
    const helper = module.call((glue) => {
      const begun = begin(glue);
      module.keep(begun);
      return begun;
    });
    return { module: module as unknown as LoadedModule<Glue>, helper };
  };
  if ("views" in input) {
    const own = { ...input, mesh: ownMesh };
    return kept(await joint(), (j) => j.beginHelpViews(own, options));
  }
  const own = { ...input, mesh: ownMesh };
  if (placed === undefined) return kept(core, (c) => c.beginHelp(own, options));
  const { plan, index } = placed;
  return kept(await joint(), (j) => j.beginHelpPlace({ others: undefined, ...own }, options, plan, index));
}

/** What a tracker is called where its module keeps it. */
export const trackerName = (id: number) => `tracker ${id}`;

/** Runs a task to its end, and frees it. `input` is what its beginning reads. */
async function runTask<G extends Glue, T>(
  module: LoadedModule<G>,
  begin: (glue: G) => Task<T>,
  input: object,
  slices: Slices,
): Promise<T> {
  const check = () => slices.check();
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
      const result = module.call(() => task.step(slices.sliceMs), withoutInput);
      check();
      if (result !== undefined) return result;
      await slices.turn();
      check();
      // Another call trapped, and the task was lost with its instance.
      if (module.instance !== instance) return await runTask(module, begin, input, slices);
    }
  } finally {
    if (module.instance === instance) task.free();
    module.drop(task);
  }
}

/** Two clouds and, for `estimateSim3`, the correspondences between their points. */
type Clouds = NonNullable<Registration["input"]>;

function checkedClouds(clouds: Clouds): Clouds {
  for (const argument of ["source", "target"] as const) {
    const cloud: unknown = clouds[argument];
    if (isTypedArray(cloud, "Float32Array", "Float64Array")) continue;
    throw wrongKind(argument, cloud, "a Float32Array or a Float64Array, x, y, z per point", "Float64Array");
  }
  return clouds;
}
