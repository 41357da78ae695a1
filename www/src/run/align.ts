/** Aligns objects and reports their progress. */
import { computed, signal } from "@preact/signals";
import type { Progress } from "sim3align";
import { toSim3 } from "sim3align/conventions";
import { FieldError, fieldOf } from "../load/field-error.js";
import { fieldErrors } from "../load/open.js";
import { place } from "../state/history.js";
import type { AnyAlignment, ObjectModel } from "../state/object-model.js";
import { alignOptions, type CallOptions, refineOptions } from "../state/options.js";
import type { PoseSource } from "../state/pose.js";
import { type Scene, scene, selected } from "../state/scene.js";
import { announce, type Status, status } from "../state/status.js";
import { aligner, inputOf } from "./aligner.js";

const controller = signal<AbortController | null>(null);

export const isRunning = computed(() => controller.value !== null);

/** Progress of all objects that are being aligned, 0 to 1. */
export const fraction = computed(() => {
  const runs = (scene.value?.objects ?? []).map(({ run }) => run.value).filter(({ state }) => state !== "idle");
  const parts = runs.map((run) => (run.state === "running" ? run.fraction : run.state === "waiting" ? 0 : 1));
  return parts.length === 0 ? 0 : parts.reduce((sum, part) => sum + part, 0) / parts.length;
});

export function cancel(): void {
  controller.peek()?.abort();
}

// Running alignments belong to the previous scene.
let current = scene.peek();
scene.subscribe((next) => {
  if (next !== current) cancel();
  current = next;
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

/** Searches around the current pose of the selected object only. */
export async function refine(): Promise<void> {
  const object = selected.peek();
  if (object === null) return;
  await alignObjects([object], refineOptions(object.pose.peek().transform), "refined");
}

async function alignObjects(objects: readonly ObjectModel[], chosen: CallOptions, source: PoseSource): Promise<void> {
  const whole = scene.peek();
  if (whole === null || objects.length === 0 || controller.peek() !== null) return;
  const abort = new AbortController();
  controller.value = abort;
  fieldErrors.value = {};
  for (const { run } of whole.objects) run.value = { state: "idle" };
  for (const { run } of objects) run.value = { state: "waiting" };
  announce(objects.length === 1 ? "Aligning …" : `Aligning ${objects.length} objects …`, "working");
  try {
    await runAll(whole, objects, { ...chosen, signal: abort.signal }, source);
  } catch (error) {
    for (const { run } of objects) {
      if (run.peek().state === "done" || run.peek().state === "failed") continue;
      run.value = abort.signal.aborted ? { state: "cancelled" } : { state: "failed", error: error as Error };
    }
    if (!abort.signal.aborted) showInField(error);
  } finally {
    controller.value = null;
    status.value = summary(objects, abort.signal.aborted);
  }
}

async function runAll(
  whole: Scene,
  objects: readonly ObjectModel[],
  chosen: CallOptions,
  source: PoseSource,
): Promise<void> {
  const inputs = objects.map((object) => inputOf(whole, object));
  const [first] = inputs;
  const [only] = objects;
  if (objects.length === 1 && first !== undefined && only !== undefined) {
    const onProgress = progressOf(only);
    finish(only, await (await aligner()).align(first, { ...chosen, onProgress }), source);
    return;
  }
  const listeners = objects.map(progressOf);
  const results = (await aligner()).alignAll(inputs, {
    ...chosen,
    onProgress: (progress) => listeners[progress.index]?.(progress),
  });
  for await (const { index, alignment, error } of results) {
    const object = objects[index];
    if (object === undefined) continue;
    if (alignment !== undefined) finish(object, alignment, source);
    else {
      object.run.value = { state: "failed", error };
      showInField(error);
    }
  }
}

const progressOf =
  ({ run }: ObjectModel) =>
  ({ stage, fraction }: Progress) => {
    run.value = { state: "running", stage, fraction };
  };

function finish(object: ObjectModel, alignment: AnyAlignment, source: PoseSource): void {
  object.alignment.value = alignment;
  object.run.value = { state: "done" };
  place(object, { transform: toSim3(alignment), source });
}

/** Shows an error at the input field that it concerns, if any. */
function showInField(error: unknown): void {
  const field = fieldOf(error);
  if (field !== null) fieldErrors.value = { ...fieldErrors.peek(), [field]: new FieldError(field, error) };
}

function summary(objects: readonly ObjectModel[], isAborted: boolean): Status {
  if (isAborted) return { text: "Cancelled. The pose is unchanged.", kind: "done" };
  const failed = objects.flatMap(({ name, run }) => {
    const state = run.peek();
    return state.state === "failed" ? [`${name}: ${state.error.message}`] : [];
  });
  if (failed.length > 0) return { text: failed.join(" "), kind: "failed" };
  if (objects.length > 1) return { text: `Aligned ${objects.length} objects.`, kind: "done" };
  const ms = objects[0]?.alignment.peek()?.diagnostics.timingsMs.total ?? 0;
  return { text: `Aligned in ${(ms / 1000).toFixed(2)} s.`, kind: "done" };
}
