/** Aligns objects, and says how far it has come. */
import { computed, signal } from "@preact/signals";
import type { Alignment, AlignOptions, Progress } from "sim3align";
import { toSim3 } from "sim3align/conventions";
import { FieldError, fieldOf } from "../load/field-error.js";
import { fieldErrors } from "../load/open.js";
import { type Announcement, announcement, say } from "../state/announcement.js";
import { place } from "../state/history.js";
import type { ObjectModel } from "../state/object-model.js";
import { alignOptions, options } from "../state/options.js";
import type { PoseSource } from "../state/pose.js";
import { type Scene, scene, selected } from "../state/scene.js";
import { aligner } from "./aligner.js";
import { inputOf } from "./input.js";

const controller = signal<AbortController | null>(null);

export const isRunning = computed(() => controller.value !== null);

/** How far all objects that are being aligned have come, 0 to 1. */
export const fraction = computed(() => {
  const runs = (scene.value?.objects ?? []).map(({ run }) => run.value).filter(({ state }) => state !== "idle");
  const parts = runs.map((run) => (run.state === "running" ? run.fraction : run.state === "waiting" ? 0 : 1));
  return parts.length === 0 ? 0 : parts.reduce((sum, part) => sum + part, 0) / parts.length;
});

export function cancel(): void {
  controller.peek()?.abort();
}

// What is under way is about the old scene.
let shown = scene.peek();
scene.subscribe((now) => {
  if (now !== shown) cancel();
  shown = now;
});

/** Aligns the selected object from scratch. */
export async function alignSelected(): Promise<void> {
  const object = selected.peek();
  if (object !== null) await alignObjects([object], alignOptions(), "aligned");
}

/** Aligns every object of the scene. */
export async function alignAll(): Promise<void> {
  await alignObjects(scene.peek()?.objects ?? [], alignOptions(), "aligned");
}

/** Searches around the selected object's present pose alone. */
export async function refine(): Promise<void> {
  const object = selected.peek();
  if (object === null) return;
  const { quality, seed, symmetry, lockScale } = options.peek();
  const local = { quality, seed, symmetry, lockScale, search: "local", initial: object.pose.peek().transform } as const;
  await alignObjects([object], local, "refined");
}

async function alignObjects(objects: readonly ObjectModel[], chosen: AlignOptions, source: PoseSource): Promise<void> {
  const whole = scene.peek();
  if (whole === null || objects.length === 0 || controller.peek() !== null) return;
  const abort = new AbortController();
  controller.value = abort;
  fieldErrors.value = {};
  for (const { run } of whole.objects) run.value = { state: "idle" };
  for (const { run } of objects) run.value = { state: "waiting" };
  say(objects.length === 1 ? "Aligning …" : `Aligning ${objects.length} objects …`, "working");
  try {
    await runAll(whole, objects, { ...chosen, signal: abort.signal }, source);
  } catch (error) {
    for (const { run } of objects) {
      if (run.peek().state === "done" || run.peek().state === "failed") continue;
      run.value = abort.signal.aborted ? { state: "cancelled" } : { state: "failed", error: error as Error };
    }
    if (!abort.signal.aborted) explain(error);
  } finally {
    controller.value = null;
    announcement.value = summary(objects, abort.signal.aborted);
  }
}

async function runAll(
  whole: Scene,
  objects: readonly ObjectModel[],
  chosen: AlignOptions,
  source: PoseSource,
): Promise<void> {
  const inputs = objects.map((object) => inputOf(whole, object));
  const [first] = inputs;
  const [only] = objects;
  if (objects.length === 1 && first !== undefined && only !== undefined) {
    const onProgress = follow(only);
    finish(only, await (await aligner()).align(first, { ...chosen, onProgress }), source);
    return;
  }
  const followers = objects.map(follow);
  const { initial: _, ...forAll } = chosen;
  const results = (await aligner()).alignAll(inputs, {
    ...forAll,
    onProgress: (progress) => followers[progress.index]?.(progress),
  });
  for await (const { index, alignment, error } of results) {
    const object = objects[index];
    if (object === undefined) continue;
    if (alignment !== undefined) finish(object, alignment, source);
    else {
      object.run.value = { state: "failed", error };
      explain(error);
    }
  }
}

const follow =
  ({ run }: ObjectModel) =>
  ({ stage, fraction }: Progress) => {
    run.value = { state: "running", stage, fraction };
  };

function finish(object: ObjectModel, alignment: Alignment, source: PoseSource): void {
  object.alignment.value = alignment;
  object.run.value = { state: "done" };
  place(object, { transform: toSim3(alignment), source });
}

/** An error that is about an input is shown beside its field, too. */
function explain(error: unknown): void {
  const field = fieldOf(error);
  if (field !== null) fieldErrors.value = { ...fieldErrors.peek(), [field]: new FieldError(field, error) };
}

function summary(objects: readonly ObjectModel[], isAborted: boolean): Announcement {
  if (isAborted) return { text: "Cancelled. The mesh is where it was.", kind: "done" };
  const failed = objects.flatMap(({ name, run }) => {
    const state = run.peek();
    return state.state === "failed" ? [`${name}: ${state.error.message}`] : [];
  });
  if (failed.length > 0) return { text: failed.join(" "), kind: "failed" };
  if (objects.length > 1) return { text: `Aligned ${objects.length} objects.`, kind: "done" };
  const ms = objects[0]?.alignment.peek()?.timingsMs.total ?? 0;
  return { text: `Aligned in ${(ms / 1000).toFixed(2)} s.`, kind: "done" };
}
