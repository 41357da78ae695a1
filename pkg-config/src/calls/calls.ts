/** The calls as data, so that the same code runs them on the calling thread or in a worker. */

import type { Alignment, CorrectedFrame, Warning } from "../generated/types.js";
import { type MeshAndWarnings, readCoreMesh, readMesh } from "../input/mesh.js";
import { resolveFrame, resolveInput, resolveViews, withMesh } from "../input/resolve.js";
import type { CoreFrame, CoreInput, CoreView } from "../modules/core-input.js";
import type {
  Calibrated,
  CalibrationObject,
  Core,
  Joint,
  ModuleName,
  Placed,
  PlacedInput,
} from "../modules/exports.js";
import type { ModuleTable } from "../modules/module.js";
import type { AlignInput, FrameInput, MeshInput, ViewsInput } from "../types/inputs.js";
import type {
  AlignResult,
  Evaluation,
  InputNotes,
  Registration,
  TrackedFrame,
  ViewAlignment,
  ViewsAlignment,
} from "../types/results.js";
import { failure, isOfInput } from "../values/error.js";
import { isTypedArray } from "../values/kinds.js";
import { withoutUndefined, wrongKind } from "../values/validation.js";
import { checkMeasurable, inCalibration, isRaw, mayBeRaw } from "./calibrate.js";
import type { JobContext } from "./context.js";
import { DOUBT, sourcesOf, withDoubts, withNotes } from "./notes.js";
import { fromOrigin, toOrigin } from "./origin.js";

/** Two clouds and, for `estimateSim3`, the correspondences between their points. */
type Clouds = NonNullable<Registration["input"]>;

/** A view, and the objects by which it is calibrated, whose meshes have not been read. */
type CalibrateInput = CoreView & { objects: (Omit<CalibrationObject, "mesh"> & { mesh: unknown })[] };

/** An object of a scene, whose mesh has not been read. */
type PlaceInput = Omit<PlacedInput, "mesh"> & { mesh: unknown };

/** The calls: their data, which contain all large arrays, what else they are given, in the form of the core, and their results. */
interface Calls {
  align: { data: AlignInput; options: object; result: AlignResult };
  alignPaper: { data: AlignInput; options: object; result: AlignResult };
  evaluate: { data: AlignInput; options: { transform: unknown; settings: object }; result: Evaluation };
  prepareMesh: { data: { mesh: MeshInput }; options: object; result: MeshAndWarnings };
  alignViews: { data: ViewsInput; options: object; result: ViewsAlignment };
  calibrate: { data: CalibrateInput; options: object; result: Calibrated };
  place: { data: PlaceInput; options: object; result: Placed };
  openTracker: { data: { mesh: MeshInput }; options: { tracker: number; settings: object }; result: object };
  trackFrame: { data: FrameInput; options: { tracker: number }; result: TrackedFrame };
  correctTrack: { data: { pose: unknown; frame: unknown }; options: { tracker: number }; result: CorrectedFrame[] };
  register: { data: Clouds; options: object; result: Registration };
  estimateSim3: { data: Clouds; options: object; result: Registration };
}

/** The name of a call. */
export type Method = keyof Calls;

/** The data of a call. */
export type DataOf<M extends Method> = Calls[M]["data"];

/** The options of a call. */
export type SettingsOf<M extends Method> = Calls[M]["options"];

/** The result of a call. */
export type ResultOf<M extends Method> = Calls[M]["result"];

/** A call as data. */
export interface Job<M extends Method = Method> {
  method: M;
  data: DataOf<M>;
  options: SettingsOf<M>;
  /** The id of its prepared mesh, whose arrays are those of `data`. */
  meshId?: number | undefined;
}

/** The implementation of a call. */
interface CallOf<M extends Method> {
  /** The module without which it cannot be run, and which caches its prepared mesh. */
  module: ModuleName;
  run(job: Job<M>, context: JobContext): Promise<ResultOf<M>>;
}

/** An alignment whose warning of inverted depth has been checked, if it has one: what checks it is loaded then. */
async function withInversionChecked(
  found: Alignment,
  input: CoreInput,
  options: object,
  context: JobContext,
  kind: { alone: boolean },
): Promise<Alignment> {
  if (found.warnings.every(({ code }) => code !== "DEPTH_LOOKS_INVERTED")) return found;
  const { checkInversion } = await import("./inverted-depth.js");
  return checkInversion(found, input, options, context, kind);
}

const calls: { readonly [M in Method]: CallOf<M> } = {
  align: {
    module: "core",
    run: (job, context) =>
      aligned(job, context, job.options, async (input, context, options) => {
        const searched = await context.search("align", input, options);
        const found = await withInversionChecked(searched, input, options, context, { alone: true });
        if (found.shapeConfidence >= DOUBT && (found.diagnostics.color?.agreement ?? 1) >= DOUBT) return found;
        const { lookedAtAgain } = await import("./second-look.js");
        return lookedAtAgain(found, input, options, context);
      }),
  },
  alignPaper: {
    module: "registration",
    // What is known of the object is an option of the other method.
    run: (job, context) =>
      aligned(job, context, {}, (input, context) =>
        context.call("registration", input, (r) => r.alignPaper(input, job.options, context.listener)),
      ),
  },
  evaluate: {
    module: "core",
    async run({ data, options: { transform, settings }, meshId }, context) {
      const { core: input, notes } = await resolveInput(data, context.modules, meshId);
      checkMeasurable(input);
      const [pose, known] = [toOrigin(transform, notes.origin), toOrigin(settings, notes.origin)];
      return withNotes(await context.call("core", input, (c) => c.evaluate(input, pose, known)), notes);
    },
  },
  prepareMesh: {
    module: "core",
    async run({ data, meshId }, context) {
      const { mesh, ...notes } = await readMesh(data.mesh, context.modules, true);
      await context.call("core", { mesh }, (c) => c.prepareMesh({ ...mesh, ...withoutUndefined({ id: meshId }) }));
      return { mesh, ...notes };
    },
  },
  alignViews: {
    module: "joint",
    async run({ data, options, meshId }, context) {
      const { core: read, notes } = await resolveViews(data, context.modules, meshId);
      const isKnown = !read.views.some(isRaw);
      const [first, then] = isKnown ? [context, context] : context.parts();
      const begin = (j: Joint) => j.beginCalibrateViews({ ...read, options }, first.listener);
      const calibrated = isKnown ? [] : await first.task("joint", read, begin);
      const views = read.views.map((view, k) => inCalibration(view, calibrated[k]));
      const search = (views: readonly CoreFrame[], context: JobContext, options: object) =>
        context.search("alignViews", { ...read, views: [...views] }, options);
      const result = await search(views, then, options);
      if (contradicts(result)) {
        const { otherConvention } = await import("./camera-poses.js");
        const agree = async (views: readonly CoreFrame[]) =>
          !contradicts(await search(views, then.quiet(), { ...options, metrics: false }));
        const remedy = await otherConvention(views, agree);
        result.warnings = result.warnings.map((warning) => withRemedy(warning, remedy));
      }
      const ofView = (view: ViewAlignment, k: number) =>
        withNotes(withCalibration(view, calibrated[k]), notes[k] as InputNotes);
      const inWorld = fromOrigin({ ...result, views: [] }, read.mesh.fileOrigin);
      const ofViews = result.views.map(ofView);
      const doubts = ofViews.flatMap(({ role, warnings }) => (role === "used" ? warnings : []));
      return { ...withDoubts(inWorld, doubts), views: ofViews };
    },
  },
  calibrate: {
    module: "joint",
    async run({ data: { objects, ...view } }, context) {
      const read: CalibrationObject[] = [];
      for (const object of objects) {
        // A faulty mesh is reported where it is aligned.
        const mesh = await readCoreMesh(object.mesh, context.modules, false).catch((error) => {
          if (!isOfInput(error)) throw error;
        });
        if (mesh) read.push({ ...object, mesh: mesh.mesh, options: toOrigin(object.options, mesh.mesh.fileOrigin) });
      }
      const input = { ...view, objects: read };
      return context.task("joint", input, (j) => j.beginCalibrate(input, context.listener));
    },
  },
  place: {
    module: "joint",
    async run({ data, options, meshId }, context) {
      const isColored = data.image !== undefined;
      const read = await readCoreMesh(data.mesh, context.modules, isColored, meshId);
      const { fileOrigin: origin } = read.mesh;
      const input = { ...data, mesh: read.mesh };
      const known = toOrigin(options, origin);
      const found = await context.search("place", input, known);
      const placed = { ...found, ...withoutUndefined({ origin }) };
      if (placed.alignment === undefined) return placed;
      const alignment = await withInversionChecked(placed.alignment, input, known, context, { alone: false });
      // The view belongs to the scene, which reports what its files say.
      const notes = withMesh({ core: data, notes: { warnings: [], unread: [], colors: [] } }, read);
      return { ...placed, alignment: withNotes(alignment, notes) };
    },
  },
  openTracker: {
    module: "joint",
    async run({ data, options: { tracker, settings }, meshId }, context) {
      // Any frame may have a photo.
      const { mesh } = await readCoreMesh(data.mesh, context.modules, true, meshId);
      if (mesh.fileOrigin !== undefined) throw farMesh(mesh.fileOrigin);
      const joint = await context.modules.joint();
      joint.callWith("input", { mesh }, (j) => {
        j.openTracker(tracker, { mesh }, settings);
        joint.kept(trackerName(tracker));
      });
      return {};
    },
  },
  trackFrame: {
    module: "joint",
    async run({ data, options: { tracker } }, context) {
      const { core: frame, notes } = await resolveFrame(data, context.modules);
      const pose = await context.task("joint", frame, (j) => j.beginTrackFrame(tracker, frame, context.listener));
      return withDoubts({ ...pose, ...sourcesOf(notes) }, notes.warnings);
    },
  },
  correctTrack: {
    module: "joint",
    run: ({ data, options: { tracker } }, context) =>
      context.call("joint", data, (j) => j.correctTrack(tracker, data.pose, data.frame)),
  },
  register: {
    module: "registration",
    async run({ data, options }, context) {
      const { source, target } = checkedClouds(data);
      return context.task("registration", data, (r) => r.beginRegister(source, target, options));
    },
  },
  estimateSim3: {
    module: "registration",
    async run({ data, options }, context) {
      const { source, target, correspondences } = checkedClouds(data);
      if (!isTypedArray<Uint32Array>(correspondences, "Uint32Array")) {
        throw wrongKind("correspondences", correspondences, "a Uint32Array of index pairs", "Uint32Array");
      }
      return context.task("registration", data, (r) => r.beginEstimateSim3(source, target, correspondences, options));
    },
  },
};

/** Runs a job. */
export function perform<M extends Method>(job: Job<M>, context: JobContext): Promise<ResultOf<M>> {
  const call: CallOf<M> = calls[job.method];
  return call.run(job, context);
}

/** The module without which a call cannot be run, and which caches its prepared mesh. */
export const moduleOf = (method: Method): ModuleName => calls[method].module;

/** The modules that cache prepared meshes, each its own copy. */
const meshCaches = ["core", "joint"] as const;

/** Whether a call takes its prepared mesh from the cache of its module: that of the core is not that of calibration. */
export const cachesMesh = (method: Method, data: unknown): boolean =>
  method !== "alignPaper" && !(method === "align" && mayBeRaw(data));

/** Frees what modules have derived from a prepared mesh. */
export function dropMesh(id: number, modules: ModuleTable): void {
  for (const name of meshCaches) modules[name].loaded?.call((cache: Core | Joint) => cache.dropMesh(id));
}

function farMesh(origin: readonly number[]) {
  const found = `coordinates around ${origin.map((x) => Math.round(x)).join(", ")}`;
  return failure("INVALID_ARGUMENT", "mesh", found, "coordinates near zero", "Subtract the centre from the mesh file.");
}

/** The key of a tracker in its module. */
export const trackerName = (id: number) => `tracker ${id}`;

/** Aligns an input, whose view is first calibrated by the object, unless its depth and lens are known. */
async function aligned<T extends AlignResult>(
  { data, meshId }: Job<"align" | "alignPaper">,
  context: JobContext,
  options: object,
  align: (input: CoreInput, context: JobContext, options: object) => Promise<T>,
): Promise<T> {
  const { core: read, notes } = await resolveInput(data, context.modules, meshId);
  const known = toOrigin(options, notes.origin);
  if (!isRaw(read)) return withNotes(await align(read, context, known), notes);
  const [first, then] = context.parts();
  const { mesh, mask, maskWidth, maskHeight, resizeMask, ...view } = read;
  const { id: _, ...own } = mesh;
  const object = withoutUndefined({ mask, maskWidth, maskHeight, resizeMask, mesh: own, options: known });
  const input = { ...view, objects: [object as CalibrationObject] };
  const calibrated = await first.task("joint", input, (j) => j.beginCalibrate(input, first.listener));
  const found = await align(inCalibration(read, calibrated), then, known);
  return withNotes(withCalibration(found, calibrated), notes);
}

/** Whether no majority of the views with camera poses agrees. */
function contradicts({ world, views }: ViewsAlignment): boolean {
  const count = (role: ViewAlignment["role"]) => views.filter((view) => view.role === role).length;
  return world === "given" && count("contradicting") >= count("used");
}

const withRemedy = (warning: Warning, remedy: string | undefined): Warning =>
  remedy === undefined || warning.code !== "VIEW_CONTRADICTS"
    ? warning
    : { ...warning, message: `${warning.message} They agree if the camera poses ${remedy}.` };

const withCalibration = <T extends object>(result: T, calibrated: Calibrated | undefined): T =>
  calibrated === undefined ? result : { ...result, depthCalibration: calibrated.calibration };

function checkedClouds(clouds: Clouds): Clouds {
  for (const argument of ["source", "target"] as const) {
    const cloud: unknown = clouds[argument];
    if (isTypedArray(cloud, "Float32Array", "Float64Array")) continue;
    throw wrongKind(argument, cloud, "a Float32Array or a Float64Array, x, y, z per point", "Float64Array");
  }
  return clouds;
}
