/** Opens scenes: samples at once, the user's own files by way of a draft. */
import { draft } from "../state/draft.js";
import { page } from "../state/page.js";
import type { NamedFile } from "./files.js";
import { readInputs, sceneOf } from "./read-scene.js";
import { type Sample, sampleInputs } from "./samples.js";

const { announce, inputs, isReading, objects, queue, scene, show } = page;

/** The number of the last call of `openSample`. The results of earlier calls are discarded. */
let lastCall = 0;
objects.subscribe(() => {
  lastCall++;
});

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

page.fileActions.value = { edit: editInputs, next: openNext };
