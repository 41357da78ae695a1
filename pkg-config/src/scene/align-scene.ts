/** Aligns the objects of a scene, on this thread or in workers. */
import { inCalibration, isRaw } from "../calls/calibrate.js";
import { type Call, type Engine, signalsOf } from "../calls/engine.js";
import { withDoubts, withNotes } from "../calls/notes.js";
import { fromOrigin } from "../calls/origin.js";
import { ProgressListener } from "../calls/progress.js";
import { checkSignals, onAnyAbort } from "../concurrency/on-abort.js";
import { coreSim3, type Sim3 } from "../input/sim3.js";
import type { Arrangement, Calibrated, Placed } from "../modules/exports.js";
import type { Modules } from "../modules/module.js";
import type { Progress } from "../types/options.js";
import type { SceneAlignment, SceneFailure, SceneInput, SceneMetrics, SceneResult } from "../types/scene.js";
import { isOfInput, Sim3AlignError } from "../values/error.js";
import { withArrays } from "../values/prepared-mesh.js";
import { withoutUndefined } from "../values/validation.js";
import { othersOf, type ReadObject, type ReadScene, readScene } from "./read-scene.js";

type PlacedOrError = Placed | Sim3AlignError;

/** Shares of the work of a scene: of its calibration, where there is one; and of what follows, that of each object alone. */
const CALIBRATION = 0.5;
const ALONE = 0.75;

/** Errors of one object; every other one, such as that of an option, ends the call. */
const isOwn = (error: unknown): error is Sim3AlignError => isOfInput(error) && !error.argument.startsWith("options");

/** Aligns a scene in the rounds of its plan, which the joint module makes. */
export async function alignScene(
  input: SceneInput,
  modules: Modules,
  engine: Engine,
  { options, snap }: { options: Record<string, unknown>; snap: boolean },
  call: Call,
): Promise<SceneResult> {
  const read = await readScene(input, modules);
  const stopped = new AbortController();
  const unfollow = onAnyAbort(signalsOf(call), (reason) => stopped.abort(reason));
  const running = { engine, options, progress: call.progress, stopped };
  try {
    checkSignals(signalsOf(call));
    const calibrated = isRaw(read.view) ? await calibratedScene(read, running) : undefined;
    const scene = { ...read, view: inCalibration(read.view, calibrated) };
    const { view, objects, occluders, support } = scene;
    const module = await modules.joint();
    const round = roundsOf(scene, running, calibrated === undefined ? 0 : CALIBRATION);
    const masks = [...objects.map(({ mask }) => mask), ...occluders];
    const given = { ...view, objects: objects.map(({ mask }) => ({ mask })), occluders };
    const seed = typeof options.seed === "number" ? options.seed : 0;
    let placed: PlacedOrError[] = [];
    for (let plan: Uint8Array | undefined; ; ) {
      placed = await round(plan, placed);
      const placements = placed.map((of) => (of instanceof Sim3AlignError ? null : of.placement));
      const next = module.callWith("input", given, (j) =>
        j.planScene({ ...view, masks, support, seed, snap }, plan, placements),
      );
      if (next.plan === undefined) {
        const result = resultOf(scene, placed, next);
        return calibrated === undefined ? result : { ...result, depthCalibration: calibrated.calibration };
      }
      plan = next.plan;
    }
  } finally {
    unfollow();
  }
}

function resultOf(scene: ReadScene, placed: readonly PlacedOrError[], arrangement: Arrangement): SceneResult {
  const objects = placed.map((of, i): SceneAlignment | SceneFailure => {
    const { name, maskReading } = scene.objects[i] as ReadObject;
    const named = withoutUndefined({ name });
    if (of instanceof Sim3AlignError) return { ...named, error: of };
    // Contacts may have moved the pose.
    const aligned = { ...named, ...of.alignment, ...fromOrigin(arrangement.objects[i], of.origin) };
    const read = { ...aligned, ...withoutUndefined({ maskReading }) } as SceneAlignment;
    const moved = withDoubts(read, scene.notes.warnings);
    const { proportions } = moved;
    const before = of.alignment?.translation;
    if (proportions === undefined || before === undefined) return moved;
    return { ...moved, proportions: shifted(proportions, (k) => moved.translation[k] - before[k]) };
  });
  const result = { objects, support: arrangement.support, metrics: metricsOf(objects), warnings: [] };
  return withNotes<SceneResult>(result, scene.notes);
}

/** A transform that is moved by `by` along each axis. */
function shifted<T extends Sim3>(transform: T, by: (axis: 0 | 1 | 2) => number): T {
  const { translation, matrix } = transform;
  const [x, y, z] = [0, 1, 2].map((k) => translation[k as 0] + by(k as 0)) as [number, number, number];
  return { ...transform, translation: [x, y, z], matrix: [...matrix.slice(0, 12), x, y, z, 1] };
}

/** A scene that runs. */
interface Running {
  engine: Engine;
  options: Record<string, unknown>;
  progress: ProgressListener;
  /** Ends all its jobs. */
  stopped: AbortController;
}

/** Calibrates the view of a scene by all its objects, in one job. */
async function calibratedScene(scene: ReadScene, { engine, options, progress, stopped }: Running): Promise<Calibrated> {
  const sent = scene.objects.map((object) => {
    const { mask } = object;
    const { data, release } = withArrays({ mask, mesh: object.mesh }, engine);
    return { object: { ...data, others: othersOf(scene, mask), options: plainOptions(options, object) }, release };
  });
  const report = ({ stage, fraction }: Progress) => progress.report(stage, CALIBRATION * fraction);
  const listener = new ProgressListener(progress.isWanted ? report : undefined);
  try {
    const data = { ...scene.view, objects: sent.map(({ object }) => object) };
    const job = { method: "calibrate", data, options: {} } as const;
    return (await engine.run(job, { signal: stopped.signal, progress: listener, transfer: false })).result;
  } finally {
    for (const { release } of sent) release();
  }
}

/** The options of an object, in the form of the core. */
function plainOptions(options: Record<string, unknown>, { known }: ReadObject): Record<string, unknown> {
  const own: Record<string, unknown> = { ...options, ...known };
  return own.initial === undefined ? own : { ...own, initial: coreSim3(own.initial as never) };
}

/**
 * The rounds of a scene. Each aligns each object that has not failed `before`, as many at a time as the engine runs: the
 * error of one object is its result. `begun` is the share of the work that is done.
 */
function roundsOf(scene: ReadScene, { engine, options, progress: reported, stopped }: Running, begun: number) {
  const { objects } = scene;
  const fractions = objects.map(() => 0);

  const place = async (index: number, plan: Uint8Array | undefined): Promise<Placed> => {
    const object = objects[index] as ReadObject;
    const { mask, mesh } = object;
    const input = { ...scene.view, mask, mesh, others: othersOf(scene, mask), plan, index };
    const { data, meshId, release } = withArrays(input, engine);
    const [from, to] = plan === undefined ? [0, ALONE] : [ALONE, 1];
    const report = ({ stage, fraction, best }: Progress) => {
      fractions[index] = Math.max(fractions[index] ?? 0, from + (to - from) * fraction);
      const all = fractions.reduce((sum, one) => sum + one, 0) / fractions.length;
      reported.report(stage, begun + (1 - begun) * all, undefined, { index, best });
    };
    const progress = new ProgressListener(reported.isWanted ? report : undefined);
    const job = { method: "place", data, meshId, options: plainOptions(options, object) } as const;
    try {
      const { result } = await engine.run(job, { signal: stopped.signal, progress, transfer: false });
      fractions[index] = to;
      return result;
    } finally {
      release();
    }
  };

  return async (plan: Uint8Array | undefined, before: readonly PlacedOrError[]): Promise<PlacedOrError[]> => {
    const results: PlacedOrError[] = [];
    const indices = objects.keys();
    const worker = async () => {
      for (const index of indices) {
        try {
          const failed = before[index];
          results[index] = failed instanceof Sim3AlignError ? failed : await place(index, plan);
        } catch (error) {
          if (!isOwn(error)) {
            stopped.abort(error);
            throw error;
          }
          results[index] = error;
        }
      }
    };
    await Promise.all(Array.from({ length: Math.min(engine.capacity, objects.length) }, worker));
    return results;
  };
}

function metricsOf(objects: readonly (SceneAlignment | SceneFailure)[]): SceneMetrics {
  const contacts = objects.flatMap((object) => (object.error === undefined ? [object.contact] : []));
  const resting = contacts.filter(({ restsOn }) => restsOn !== null);
  const gaps = resting.map(({ gapM }) => Math.abs(gapM ?? 0)).sort((a, b) => a - b);
  const gapAt = (place: number) => gaps[Math.floor(place)] ?? 0;
  const median = (gapAt((gaps.length - 1) / 2) + gapAt(gaps.length / 2)) / 2;
  const sum = contacts.reduce((all, { sharedVolume }) => all + sharedVolume, 0);
  return {
    aligned: contacts.length,
    resting: resting.length,
    medianGapM: gaps.length === 0 ? null : median,
    sharedVolume: contacts.length === 0 ? 0 : sum / contacts.length,
  };
}
