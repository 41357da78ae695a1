/** Aligns objects, reports their progress, and shows the alternatives of a result. */
import type { Progress, SceneObjectInput } from "sim3align";
import { toSim3 } from "sim3align/conventions/similarity";
import { inCalibration } from "../state/calibration.js";
import type { AnyAlignment, ObjectModel } from "../state/object-model.js";
import type { Pose, PoseSource } from "../state/pose.js";
import { isResult, tightBoundsOf } from "../state/pose.js";
import type { Status } from "../state/running.js";
import type { Scene } from "../state/scene.js";
import type { Workspace } from "../state/workspace.js";
import { aligner, givenViewOf, inputOf, viewOf } from "./aligner.js";

/** Aligns the selected object from scratch. */
export const alignSelected = (workspace: Workspace) => searchSelected(workspace, "global");

/** Searches around the current pose of the selected object only. */
export const refine = (workspace: Workspace) => searchSelected(workspace, "local");

async function searchSelected(workspace: Workspace, search: "global" | "local"): Promise<void> {
  const object = workspace.selected.peek();
  if (object === null || object.isLocked.peek()) return;
  const whole = workspace.scene.peek();
  // A view is calibrated by all its objects; the poses of the others are kept.
  const isFirst = whole?.raw != null && (whole.calibration === null || whole.objects.length === 1);
  if (search === "global" && isFirst) return alignAll(workspace);
  await run(workspace, [object], (whole, signal) => alone(workspace, whole, object, search, signal));
}

/** Aligns every object of the scene, except those whose poses a person has decided on. The only one is meant, if it is not locked. */
export async function alignAll(workspace: Workspace): Promise<void> {
  const whole = workspace.scene.peek();
  const isOne = whole?.objects.length === 1;
  const objects = whole?.objects.filter(({ isHeld, isLocked }) => !(isOne ? isLocked.peek() : isHeld)) ?? [];
  const [only] = objects;
  if (whole === null) return;
  if (whole.raw !== null) await run(workspace, objects, (whole, signal) => together(workspace, whole, objects, signal));
  else if (isOne && only !== undefined) {
    await run(workspace, objects, (whole, signal) => alone(workspace, whole, only, "global", signal));
  } else if (workspace.options.peek().preset === "paper")
    await run(workspace, objects, (whole, signal) => eachAlone(workspace, whole, objects, signal));
  else await run(workspace, objects, (whole, signal) => together(workspace, whole, objects, signal));
  const held = whole.objects.length - objects.length;
  const { text, kind } = workspace.status.peek();
  if (held === 0 || kind === "failed") return;
  const left = `${held} decided, chosen or locked ${held === 1 ? "pose is" : "poses are"} left unchanged`;
  workspace.announce(only === undefined ? `${left}: align one by its menu.` : `${text} ${left}.`);
}

/** Aligns every object as if it were alone: sooner than together, and without the module that scenes need. */
export async function alignEach(workspace: Workspace): Promise<void> {
  const whole = workspace.scene.peek();
  const objects = whole?.objects ?? [];
  if (objects.length < 2 || whole?.raw != null) return alignAll(workspace);
  const running = run(workspace, objects, (whole, signal) => eachAlone(workspace, whole, objects, signal));
  // This thread is idle now, and results show the sizes of these boxes.
  for (const { mesh } of objects) setTimeout(() => tightBoundsOf(mesh));
  await running;
}

type Work = (whole: Scene, signal: AbortSignal) => Promise<void>;

/** Runs an alignment of objects, unless another one is running. */
export async function run(
  { scene, controller, announce, fileActions, status }: Workspace,
  objects: readonly ObjectModel[],
  work: Work,
): Promise<void> {
  const whole = scene.peek();
  if (whole === null || objects.length === 0 || controller.peek() !== null) return;
  const abort = new AbortController();
  controller.value = abort;
  for (const { run } of whole.objects) run.value = { state: "idle" };
  for (const { run } of objects) run.value = { state: "waiting" };
  announce(objects.length === 1 ? "Aligning …" : `Aligning ${objects.length} objects …`, "working");
  const started = performance.now();
  const wasAccepted = objects.some(({ isAccepted }) => isAccepted.peek());
  try {
    await work(whole, abort.signal);
  } catch (error) {
    for (const { run } of objects) {
      if (run.peek().state === "done" || run.peek().state === "failed") continue;
      run.value = abort.signal.aborted ? { state: "cancelled" } : { state: "failed", error: error as Error };
    }
  } finally {
    // Another scene may have taken its place, and be aligning already.
    if (controller.peek() === abort) {
      controller.value = null;
      const ms = performance.now() - started;
      const back = wasAccepted ? " Undo brings the accepted pose back." : "";
      const { text, kind } = summary(objects, abort.signal.aborted, ms, fileActions.peek()?.words);
      status.value = { text: text + back, kind };
    }
  }
}

/** Aligns one object. */
async function alone(
  workspace: Workspace,
  whole: Scene,
  object: ObjectModel,
  search: "global" | "local",
  signal: AbortSignal,
): Promise<void> {
  const { alignOptions, options, paperOptions } = workspace;
  const input = inputOf(whole, object);
  const shared = { signal, onProgress: progressOf(object) };
  const isPaper = search === "global" && options.peek().preset === "paper";
  const ready = await aligner();
  const alignment = isPaper
    ? await ready.align(input, { ...paperOptions(), ...shared })
    : await ready.align(input, { ...alignOptions(object, search), ...shared });
  finish(workspace, object, alignment, search === "local" ? "refined" : "aligned");
}

/** Aligns objects side by side, each as if it were alone. No scale of theirs is known yet. */
async function eachAlone(
  workspace: Workspace,
  whole: Scene,
  objects: readonly ObjectModel[],
  signal: AbortSignal,
): Promise<void> {
  const { constraintsOf, options, paperOptions, sceneOptions } = workspace;
  const listeners = objects.map(progressOf);
  const inputs = objects.map((object) => inputOf(whole, object));
  const onProgress = (progress: Progress & { index: number }) => listeners[progress.index]?.(progress);
  const shared = { signal, onProgress };
  const ready = await aligner();
  const [first] = objects;
  const results =
    options.peek().preset === "paper" || first === undefined
      ? ready.alignAll(inputs, { ...paperOptions(), ...shared })
      : ready.alignAll(inputs, { ...sceneOptions(), ...constraintsOf(first), initial: null, ...shared });
  for await (const { index, alignment, error } of results) {
    const object = objects[index];
    if (object === undefined) continue;
    if (alignment !== undefined) finish(workspace, object, alignment, "aligned");
    else object.run.value = { state: "failed", error };
  }
}

/** Aligns objects together: they hide one another, share no space, and stand on something. */
async function together(
  workspace: Workspace,
  whole: Scene,
  objects: readonly ObjectModel[],
  signal: AbortSignal,
): Promise<void> {
  const { constraintsOf, recalibrate, record, sceneOptions, support } = workspace;
  // Poses that are held are in the present calibration.
  const calibrates = whole.raw !== null && objects.length === whole.objects.length;
  const inputs = whole.objects.map((object): SceneObjectInput => {
    const { mask, mesh } = object;
    // A pose that is held counts for the others.
    const pose = objects.includes(object) || !object.isPlaced ? null : object.pose.peek().transform;
    const kept = pose === null ? {} : ({ search: "local", initial: pose, scale: pose.scale } as const);
    return { mask, mesh, ...constraintsOf(object), ...kept };
  });
  const listeners = whole.objects.map((object) => (objects.includes(object) ? progressOf(object) : null));
  const onProgress = (progress: Progress & { index: number }) => {
    if (!signal.aborted) listeners[progress.index]?.(progress);
  };
  const input = { ...(calibrates ? givenViewOf(whole) : viewOf(whole)), objects: inputs };
  const result = await (await aligner()).alignScene(input, { ...sceneOptions(), signal, onProgress });
  const { depthCalibration, warnings } = result;
  record(objects[0] as ObjectModel, () => {
    if (depthCalibration !== undefined) {
      const more = warnings.map(({ message }) => message);
      recalibrate(inCalibration(whole, depthCalibration, more));
    }
    support.value = result.support;
    result.objects.forEach((found, i) => {
      const object = whole.objects[i];
      if (object === undefined || !objects.includes(object)) return;
      if (found.error === undefined) {
        object.pose.value = poseOf(withoutStated(found, whole), "aligned");
        object.run.value = { state: "done" };
      } else {
        // A pose in another calibration means nothing.
        if (depthCalibration !== undefined) object.pose.value = object.start.value;
        object.run.value = { state: "failed", error: found.error };
      }
    });
  });
}

/** Reports the progress of an alignment of the object. */
export const progressOf =
  ({ run }: ObjectModel) =>
  ({ stage, fraction }: Progress) => {
    run.value = { state: "running", stage, fraction };
  };

/** The pose that an alignment has found. */
export const poseOf = (alignment: AnyAlignment, source: PoseSource): Pose => ({
  ...{ transform: toSim3(alignment), source, alignment },
});

/** The package gets a depth map in metres: only the page knows whether its file has stated a unit. */
function withoutStated<T extends AnyAlignment>(alignment: T, { depthUnit }: Scene): T {
  if (depthUnit.isAssumed) return alignment;
  return { ...alignment, warnings: alignment.warnings.filter(({ code }) => code !== "SIZE_DOUBTFUL") };
}

function finish({ place, scene }: Workspace, object: ObjectModel, alignment: AnyAlignment, source: PoseSource): void {
  object.run.value = { state: "done" };
  const whole = scene.peek();
  place(object, poseOf(whole === null ? alignment : withoutStated(alignment, whole), source));
}

function summary(
  objects: readonly ObjectModel[],
  isAborted: boolean,
  ms: number,
  words = ({ message }: Error) => message,
): Status {
  if (isAborted) return { text: "Cancelled. The pose is unchanged.", kind: "done" };
  const failed = objects.flatMap(({ name, run }) => {
    const state = run.peek();
    return state.state === "failed" ? [`${name}: ${words(state.error)}`] : [];
  });
  if (failed.length > 0) return { text: failed.join(" "), kind: "failed" };
  const what = objects.length > 1 ? `${objects.length} objects ` : "";
  return { text: `Aligned ${what}in ${(ms / 1000).toFixed(2)}\u00a0s.`, kind: "done" };
}

/** Sets the pose to an alternative, or with −1 to the result. */
export function applyAlternative({ place }: Workspace, object: ObjectModel, index: number): void {
  const alignment = object.alignment.peek();
  if (alignment === null) return;
  const chosen = index < 0 ? alignment : object.precise?.alternatives[index];
  if (chosen === undefined) return;
  const transform = toSim3(chosen);
  place(
    object,
    index < 0
      ? { transform, source: "aligned", alignment }
      : { transform, source: "alternative", alternative: index, alignment },
  );
}

/** The index of the alternative that is shown: −1 is the result, null is another pose. */
export function shownAlternative(object: ObjectModel): number | null {
  const { source, alternative } = object.pose.value;
  if (source === "alternative") return alternative ?? null;
  return isResult(source) ? -1 : null;
}
