/** Opens scenes: samples at once, the user's own files by way of a draft. */
import { alignAll } from "../run/align.js";
import { draft } from "../state/draft.js";
import type { Listed } from "../state/opened.js";
import { page } from "../state/page.js";
import { type Progress, progressIn } from "../state/progress.js";
import type { NamedFile } from "./files.js";
import type { Inputs } from "./inputs.js";
import { readInputs, sceneOf } from "./read-scene.js";
import { type Sample, sampleInputs, samples } from "./samples.js";

const { announce, inputs, isReading, list, objects, scene, show } = page;

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
  show(opened, next);
  return true;
}

const intake = () => import("../intake/draft.js");

/** Proposes files as a scene, or adds them to the draft. */
export async function openFiles(files: readonly NamedFile[]): Promise<void> {
  if (files.length === 0) return;
  announce("Reading files …", "working");
  await attempt(async () => (await intake()).propose(files));
}

/** Parts of the page that were not needed before cannot be loaded without a connection. */
async function attempt(work: () => Promise<unknown>): Promise<void> {
  try {
    await work();
  } catch (cause) {
    const isOffline = navigator.onLine === false || cause instanceof TypeError;
    const lost = "A part of this page could not be loaded. Connect to the network, and try again.";
    announce(isOffline ? lost : `${cause}`, "failed");
  }
}

/** Makes the inputs of the scene that is shown a draft. */
export async function editInputs(): Promise<void> {
  if (draft.peek() === null) await attempt(async () => (await intake()).edit(inputs.peek()));
}

/** Opens a scene of the list, as it was left. */
export async function openListed({ id }: Inputs): Promise<void> {
  const inputs = list.peek().find((one) => one.inputs.id === id)?.inputs;
  if (inputs === undefined) return;
  announce(`Reading ${inputs.name} …`, "working");
  await attempt(async () => {
    const { reopen } = await import("../session/index.js");
    if (!(await reopen(inputs))) await (await intake()).proposeScenes([inputs]);
  });
}

/** How far the work on a scene of the list is. */
export function progressOf({ inputs: { id }, progress }: Listed): Progress | null {
  return id !== inputs.value.id || scene.value === null ? progress : progressIn(objects.value);
}

/** Whether an object of a scene is still to be accepted. */
export const isOpen = (one: Listed): boolean => progressOf(one)?.state !== "accepted";

/** The next scene of the list that is open, after the one that is shown. */
export function nextListed(): Inputs | null {
  const all = list.value;
  const at = all.findIndex((one) => one.inputs.id === inputs.value.id);
  return [...all.slice(at + 1), ...all.slice(0, Math.max(at, 0))].find(isOpen)?.inputs ?? null;
}

/** Opens it or, if all are done, the one that follows. */
export async function openNext(): Promise<void> {
  const all = list.peek();
  const at = all.findIndex((one) => one.inputs.id === inputs.peek().id);
  const next = nextListed() ?? all[(at + 1) % all.length]?.inputs;
  if (next !== undefined) await openListed(next);
}

/** Shows the next scene of the list or, without any, the first sample. */
export async function openAnother(): Promise<void> {
  const [first] = samples;
  if (list.peek().length > 0) await openNext();
  else if (first !== undefined && (await openSample(first))) await alignAll(page);
}

page.fileActions.value = { edit: editInputs, next: openNext };
