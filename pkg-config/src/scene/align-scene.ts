/** Aligns the objects of a scene: each alone, then each with what the others have told. */
import { checkAttached } from "../attached.js";
import { type Call, type Engine, signalsOf } from "../engine.js";
import { Sim3AlignError } from "../error.js";
import type { Job, Modules, PlaceInput } from "../jobs.js";
import { onAbort, reasonOf } from "../on-abort.js";
import type { Progress } from "../options.js";
import { withArrays } from "../prepared-mesh.js";
import { ProgressListener } from "../progress.js";
import { type Alignment, withWarnings } from "../results.js";
import { coreSim3 } from "../sim3.js";
import { inputOf, type ReadObject, type ReadScene, readScene } from "./read-scene.js";
import type { Ground, Known, Placed, Placement } from "./steps.js";
import type { SceneAlignment, SceneFailure, SceneInput, SceneMetrics, SceneResult } from "./types.js";

/** The options of a scene: those of the core, and `snap`. */
export interface SceneSettings {
  options: Record<string, unknown>;
  snap: boolean;
}

/** Share of the work of a scene that each object takes alone. */
const ALONE = 0.75;

/** Errors of one object; every other one, such as that of an option, ends the call. */
const isOwn = (error: unknown): error is Sim3AlignError =>
  error instanceof Sim3AlignError &&
  !["DISPOSED", "WORKER_FAILED", "INTERNAL", "NOT_INITIALISED"].includes(error.code) &&
  !error.argument.startsWith("options");

/** Aligns a scene. */
export async function alignScene(
  input: SceneInput,
  { formats, joint }: Modules,
  engine: Engine,
  { options, snap }: SceneSettings,
  call: Call,
): Promise<SceneResult> {
  const scene = await readScene(input, formats);
  const module = await joint();
  const run = new SceneRun(scene, engine, options, call);
  try {
    const alone = await run.each((index) => run.place(index));
    const placements = alone.map((placed) => (placed instanceof Sim3AlignError ? null : placed.placement));
    const view = { ...scene.view, masks: [...scene.objects.map(({ mask }) => mask), ...scene.occluders] };
    // The thread may have been elsewhere since the scene was read.
    checkAttached("input", { ...scene.view, objects: scene.objects.map(({ mask }) => ({ mask })) });
    checkAttached("occluders", scene.occluders);
    const seed = typeof options.seed === "number" ? options.seed : 0;
    const supported = module.call((j) => j.sceneSupport(view, placements, scene.support, seed));
    const { support, grounds } = supported;
    const together = await run.each(async (index) => {
      const failed = alone[index];
      if (failed instanceof Sim3AlignError) throw failed;
      return run.place(index, knownOf(index, placements, grounds));
    });
    const bodies = together.map((placed) => (placed instanceof Sim3AlignError ? null : placed.placement));
    const contacts = module.call((j) => j.sceneContacts(scene.view, bodies, supported, snap));
    const objects = together.map((placed, i): SceneAlignment | SceneFailure => {
      const { name } = scene.objects[i] as ReadObject;
      const named = name === undefined ? {} : { name };
      if (placed instanceof Sim3AlignError) return { ...named, error: placed };
      const alignment = placed.alignment as Alignment;
      const contact = contacts[i] as SceneAlignment["contact"];
      return { ...named, ...moved(alignment, grounds[i] ?? null, contact.snappedM), contact };
    });
    const result: SceneResult = { objects, support, metrics: metricsOf(objects), warnings: [] };
    return withWarnings(result, { camera: scene.warnings, colors: [] });
  } finally {
    run.end();
  }
}

/** Confidence from which on an object takes space; see `src/scene/task.rs`. */
const SOLID = 0.5;

function knownOf(index: number, placements: (Placement | null)[], grounds: (Ground | null)[]): Known {
  const solid = placements.filter((other, k): other is Placement => k !== index && (other?.confidence ?? 0) > SOLID);
  const layers = solid.map(({ origin, layerWidth, spans }) => ({ origin, layerWidth, spans }));
  return { placement: placements[index] as Placement, ground: grounds[index] ?? null, layers };
}

/** The steps of the objects of a scene. */
class SceneRun {
  readonly #scene: ReadScene;
  readonly #engine: Engine;
  readonly #options: Record<string, unknown>;
  readonly #call: Call;
  /** The fraction of each object. */
  readonly #fractions: number[];
  readonly #stopped = new AbortController();
  readonly #unfollow: (() => void)[];

  constructor(scene: ReadScene, engine: Engine, options: Record<string, unknown>, call: Call) {
    this.#scene = scene;
    this.#engine = engine;
    this.#options = options;
    this.#call = call;
    this.#fractions = scene.objects.map(() => 0);
    this.#unfollow = signalsOf(call).map((signal) => {
      if (signal.aborted) this.#stopped.abort(reasonOf(signal));
      return onAbort(signal, (reason) => this.#stopped.abort(reason));
    });
  }

  /** Runs a step of each object, as many at a time as the engine runs. The error of one object is its result. */
  async each<T>(step: (index: number) => Promise<T>): Promise<(T | Sim3AlignError)[]> {
    const results: (T | Sim3AlignError)[] = [];
    let next = 0;
    const worker = async () => {
      for (let index = next++; index < this.#scene.objects.length; index = next++) {
        try {
          results[index] = await step(index);
        } catch (error) {
          if (!isOwn(error)) {
            this.#stopped.abort(error);
            throw error;
          }
          results[index] = error;
        }
      }
    };
    const workers = Math.min(this.#engine.capacity, this.#scene.objects.length);
    await Promise.all(Array.from({ length: workers }, worker));
    return results;
  }

  /** Aligns an object alone or, with `known`, with what the others have told. */
  async place(index: number, known?: Known): Promise<Placed> {
    const { input, others } = inputOf(this.#scene, index);
    const { known: own } = this.#scene.objects[index] as ReadObject;
    const options: Record<string, unknown> = { ...this.#options, ...own };
    if (options.initial !== undefined) options.initial = coreSim3(options.initial as never);
    const { release, ...sent } = withArrays({ ...input, others, known } satisfies PlaceInput, this.#engine);
    const from = known === undefined ? 0 : ALONE;
    const share = known === undefined ? ALONE : 1 - ALONE;
    const report = (state: Progress) => this.#report(index, from + share * state.fraction, state);
    const progress = new ProgressListener(this.#call.progress.isWanted ? report : undefined);
    const call = { signal: this.#stopped.signal, progress, transfer: false };
    const job = { method: "place", ...sent, options } as Job & { method: "place" };
    try {
      const { result } = await this.#engine.run(job, call);
      this.#fractions[index] = from + share;
      return result;
    } finally {
      release();
    }
  }

  end(): void {
    for (const end of this.#unfollow) end();
  }

  #report(index: number, fraction: number, state: Progress): void {
    this.#fractions[index] = Math.max(this.#fractions[index] ?? 0, fraction);
    const all = this.#fractions.reduce((sum, one) => sum + one, 0) / this.#fractions.length;
    this.#call.progress.report(state.stage, all, undefined, { index, best: state.best });
  }
}

/** The alignment, moved along the normal of its ground. */
function moved(alignment: Alignment, ground: Ground | null, byM: number): Alignment {
  if (ground === null || byM === 0) return alignment;
  const shift = ground.normal.map((x) => x * byM);
  const translation = alignment.translation.map((x, i) => x + (shift[i] ?? 0)) as Alignment["translation"];
  const matrix = alignment.matrix.map((x, i) => (i >= 12 && i < 15 ? x + (shift[i - 12] ?? 0) : x));
  return { ...alignment, translation, matrix };
}

function metricsOf(objects: readonly (SceneAlignment | SceneFailure)[]): SceneMetrics {
  const contacts = objects.flatMap((object) => (object.error === undefined ? [object.contact] : []));
  const resting = contacts.filter(({ restsOn }) => restsOn !== null);
  const gaps = resting.map(({ gapM }) => Math.abs(gapM ?? 0)).sort((a, b) => a - b);
  const middle = Math.floor(gaps.length / 2);
  const upper = gaps[middle];
  const sum = contacts.reduce((all, { sharedVolume }) => all + sharedVolume, 0);
  return {
    aligned: contacts.length,
    resting: resting.length,
    medianGapM: upper === undefined ? null : gaps.length % 2 === 1 ? upper : ((gaps[middle - 1] ?? upper) + upper) / 2,
    sharedVolume: contacts.length === 0 ? 0 : sum / contacts.length,
  };
}
