/** Computes the metrics of the current poses. */
import { effect } from "@preact/signals";
import { toSim3 } from "sim3align/conventions/similarity";
import type { ObjectModel } from "../state/object-model.js";
import { isResult } from "../state/pose.js";
import type { Scene } from "../state/scene.js";
import type { Workspace } from "../state/workspace.js";
import { aligner, inputOf } from "./aligner.js";

/** A pose is evaluated once it has been unchanged for this time: a drag changes it with every frame. */
const DEBOUNCE_MS = 120;

/** Observes the poses of all objects of the current scene. Call the returned function to stop. */
export function observePoses({ controller, scene }: Workspace): () => void {
  const isAligning = () => controller.peek() !== null;
  return effect(() => {
    const whole = scene.value;
    const stops = whole === null ? [] : whole.objects.map((object) => observe(whole, object, isAligning));
    return () => {
      for (const stop of stops) stop();
    };
  });
}

function observe(whole: Scene, object: ObjectModel, isAligning: () => boolean): () => void {
  let abort = new AbortController();
  let timer: ReturnType<typeof setTimeout> | undefined;
  const stop = effect(() => {
    const pose = object.pose.value;
    abort.abort();
    abort = new AbortController();
    clearTimeout(timer);
    const alignment = object.alignment.peek();
    const isSame =
      alignment !== null &&
      isResult(pose.source) &&
      toSim3(alignment).matrix.every((x, i) => x === pose.transform.matrix[i]);
    object.metrics.value = isSame ? alignment.metrics : null;
    object.errors.value = null;
    if (pose.source === "start" || (isSame && object.truth === null)) return;
    const { signal } = abort;
    // Errors of a result are of less interest than the results of the other objects.
    const start = () => (isSame && isAligning() ? wait() : evaluate(whole, object, signal));
    const wait = () => {
      timer = setTimeout(start, DEBOUNCE_MS);
    };
    wait();
  });
  return () => {
    stop();
    abort.abort();
    clearTimeout(timer);
  };
}

async function evaluate(whole: Scene, object: ObjectModel, signal: AbortSignal): Promise<void> {
  const { truth } = object;
  const compared = truth === null ? {} : { truth: truth.transform, symmetry: truth.symmetry };
  try {
    const { transform } = object.pose.peek();
    const { metrics, errors } = await (await aligner()).evaluate(inputOf(whole, object), transform, compared);
    if (signal.aborted) return;
    object.metrics.value = metrics;
    object.errors.value = errors;
  } catch {
    // Some poses have no metrics, for example behind the camera. They are displayed as missing.
  }
}
