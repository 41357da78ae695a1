/** Aligns the objects of a scene, on this thread or in workers. */
import { checkAttached } from "../attached.js";
import { type Call, type Engine, signalsOf } from "../engine.js";
import { Sim3AlignError } from "../error.js";
import type { Job, Modules, PlaceInput } from "../jobs.js";
import type { Arrangement, Placed } from "../joint-module.js";
import { onAbort, reasonOf } from "../on-abort.js";
import type { Progress } from "../options.js";
import { withArrays } from "../prepared-mesh.js";
import { ProgressListener } from "../progress.js";
import { withWarnings } from "../results.js";
import { coreSim3 } from "../sim3.js";
import { inputOf, type ReadObject, type ReadScene, readScene } from "./read-scene.js";
import type { SceneAlignment, SceneFailure, SceneInput, SceneMetrics, SceneResult } from "./types.js";

/** The options of a scene: those of the core, and `snap`. */
export interface SceneSettings {
  options: Record<string, unknown>;
  snap: boolean;
}

/** Share of the work of a scene that each object takes in the first round, alone. */
const ALONE = 0.75;

/** Errors of one object; every other one, such as that of an option, ends the call. */
const isOwn = (error: unknown): error is Sim3AlignError =>
  error instanceof Sim3AlignError &&
  !["DISPOSED", "WORKER_FAILED", "INTERNAL", "NOT_INITIALISED"].includes(error.code) &&
  !error.argument.startsWith("options");

/** Aligns a scene in the rounds of its plan, which the joint module makes. */
export async function alignScene(
  input: SceneInput,
  { formats, joint }: Modules,
  engine: Engine,
  { options, snap }: SceneSettings,
  call: Call,
): Promise<SceneResult> {
  const scene = await readScene(input, formats);
  const { view, objects, occluders, support } = scene;
  const module = await joint();
  const run = new SceneRun(scene, engine, options, call);
  const masks = [...objects.map(({ mask }) => mask), ...occluders];
  const seed = typeof options.seed === "number" ? options.seed : 0;
  try {
    let placed: (Placed | Sim3AlignError)[] = [];
    for (let plan: Uint8Array | undefined; ; ) {
      placed = await run.round(plan, placed);
      // The thread may have been elsewhere since the scene was read.
      checkAttached("input", { ...view, objects: objects.map(({ mask }) => ({ mask })) });
      checkAttached("occluders", occluders);
      const placements = placed.map((of) => (of instanceof Sim3AlignError ? null : of.placement));
      const next = module.call((j) => j.planScene({ ...view, masks, support, seed, snap }, plan, placements));
      if (next.plan === undefined) return resultOf(scene, placed, next);
      plan = next.plan;
    }
  } finally {
    run.end();
  }
}

function resultOf(scene: ReadScene, placed: (Placed | Sim3AlignError)[], arrangement: Arrangement): SceneResult {
  const objects = placed.map((of, i): SceneAlignment | SceneFailure => {
    const { name } = scene.objects[i] as ReadObject;
    const named = name === undefined ? {} : { name };
    if (of instanceof Sim3AlignError) return { ...named, error: of };
    // Contacts may have moved the pose.
    return { ...named, ...of.alignment, ...arrangement.objects[i] } as SceneAlignment;
  });
  const result = { objects, support: arrangement.support, metrics: metricsOf(objects), warnings: [] };
  return withWarnings<SceneResult>(result, { camera: scene.warnings, colors: [] });
}

/** The rounds of a scene. */
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

  /**
   * Aligns each object that has not failed `before`, as many at a time as the engine runs. The error of one object is its
   * result.
   */
  async round(plan: Uint8Array | undefined, before: readonly unknown[]): Promise<(Placed | Sim3AlignError)[]> {
    const { objects } = this.#scene;
    const results: (Placed | Sim3AlignError)[] = [];
    const indices = objects.keys();
    const worker = async () => {
      for (const index of indices) {
        try {
          const failed = before[index];
          results[index] = failed instanceof Sim3AlignError ? failed : await this.#place(index, plan);
        } catch (error) {
          if (!isOwn(error)) {
            this.#stopped.abort(error);
            throw error;
          }
          results[index] = error;
        }
      }
    };
    await Promise.all(Array.from({ length: Math.min(this.#engine.capacity, objects.length) }, worker));
    return results;
  }

  async #place(index: number, plan: Uint8Array | undefined): Promise<Placed> {
    const { input, others } = inputOf(this.#scene, index);
    const { known: own } = this.#scene.objects[index] as ReadObject;
    const options: Record<string, unknown> = { ...this.#options, ...own };
    if (options.initial !== undefined) options.initial = coreSim3(options.initial as never);
    const { release, ...sent } = withArrays({ ...input, others, plan, index } satisfies PlaceInput, this.#engine);
    const from = plan === undefined ? 0 : ALONE;
    const share = plan === undefined ? ALONE : 1 - ALONE;
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
