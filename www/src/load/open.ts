/** Opens scenes: samples at once, the user's own files by way of a draft. */
import { batch, signal } from "@preact/signals";
import { layers, setLayer } from "../state/display.js";
import { draft } from "../state/draft.js";
import type { ObjectModel } from "../state/object-model.js";
import { type Scene, scene } from "../state/scene.js";
import { announce } from "../state/status.js";
import type { NamedFile } from "./files.js";
import { type Inputs, noInputs } from "./inputs.js";
import { readInputs, sceneOf } from "./read-scene.js";
import { type Sample, sampleInputs } from "./samples.js";

/** The inputs of the scene that is shown, or of the sample that is being read. */
export const inputs = signal<Inputs>(noInputs);
export const isReading = signal(false);
/** Scenes of the last drop that are still to be looked at. */
export const queue = signal<readonly Inputs[]>([]);

/** The number of the last call of `openSample`. The results of earlier calls are discarded. */
let lastCall = 0;

/** Reads a sample and shows it. On failure, the scene is unchanged. */
export async function openSample(sample: Sample): Promise<boolean> {
  const call = ++lastCall;
  const next = sampleInputs(sample);
  isReading.value = true;
  const before = inputs.peek();
  if (scene.peek() === null) inputs.value = next;
  announce(`Reading ${next.name} …`, "working");
  const reading = await readInputs(next);
  if (call !== lastCall) return false;
  isReading.value = false;
  const opened = sceneOf(next, reading);
  if (opened === null) {
    inputs.value = before;
    announce(`${next.name}: ${reading.problems.map(({ message }) => message).join(" ")}`, "failed");
    return false;
  }
  queue.value = [];
  show(opened, next);
  return true;
}

/** Makes a scene the one that is shown. */
export function show(opened: Scene, from: Inputs): void {
  lastCall++;
  batch(() => {
    isReading.value = false;
    inputs.value = from;
    scene.value = opened;
    const base = opened.rgba === null ? "depth" : "photo";
    if (layers.peek().base !== base) setLayer("base", base);
  });
}

/** Takes an object out of the scene. The others keep their poses. */
export function removeObject(object: ObjectModel): void {
  const [whole, from] = [scene.peek(), inputs.peek()];
  const index = whole?.objects.indexOf(object) ?? -1;
  if (whole === null || index < 0) return;
  const without = <T>(list: readonly T[]) => list.filter((_, i) => i !== index);
  show(
    { ...whole, sample: null, objects: without(whole.objects) },
    { ...from, sample: null, objects: without(from.objects) },
  );
  announce(`Removed ${object.name}.`);
}

const intake = () => import("../intake/draft.js");

/** Proposes files as a scene, or adds them to the draft. */
export async function openFiles(files: readonly NamedFile[]): Promise<void> {
  if (files.length === 0) return;
  announce("Reading files …", "working");
  await (await intake()).propose(files);
}

/** Makes the inputs of the scene that is shown a draft. */
export async function editInputs(): Promise<void> {
  if (draft.peek() === null) await (await intake()).edit(inputs.peek());
}

/** Opens the next scene of the drop. */
export async function openNext(): Promise<void> {
  const [next, ...rest] = queue.peek();
  if (next !== undefined) await (await intake()).proposeScenes([next, ...rest]);
}
