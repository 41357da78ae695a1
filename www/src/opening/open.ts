/** Opens scenes: samples at once, the user's own files by way of a draft. */
import { alignAll } from "../alignment/align.js";
import { draft } from "../input/draft.js";
import { messageOf, onPage } from "../input/problems.js";
import { readInputs, sceneOf } from "../input/reading.js";
import type { Inputs, NamedFile } from "../state/inputs.js";
import type { Listed, NextKind, SceneKind } from "../state/opened.js";
import { page } from "../state/page.js";
import { isFrameDoubtful, type Progress, progressIn } from "../state/progress.js";
import type { FramePose } from "../state/video.js";
import { type Sample, sampleInputs, samples } from "./samples.js";

const { announce, inputs, isReading, list, objects, scene, show, video } = page;

/** The number of the last call of `openSample`. The results of earlier calls are discarded. */
let lastCall = 0;
let lastId = "";
objects.subscribe(() => {
  const { id } = inputs.peek();
  // The frames of a video, which follow one another while it is tracked, are one scene.
  if (id === "" || id !== lastId) lastCall++;
  lastId = id;
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
  await attempt(async () => (await import("../intake/drop.js")).propose(files));
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

/** Makes a change of the inputs of the scene that is shown. */
async function changeInputs(apply: (inputs: Inputs) => Inputs): Promise<void> {
  if (draft.peek() === null) await attempt(async () => (await intake()).remake(apply(inputs.peek())));
}

/** Corrects the mask of an object of the scene that is shown. */
async function correctMask(object: number): Promise<void> {
  if (draft.peek() === null) await attempt(async () => (await intake()).correct(inputs.peek(), object));
}

/** Opens a scene of the list, as it was left. */
export async function openListed({ id }: Inputs): Promise<void> {
  const listed = list.peek().find((one) => one.inputs.id === id)?.inputs;
  if (listed === undefined || (id === inputs.peek().id && scene.peek() !== null)) return;
  announce(`Reading ${listed.name} …`, "working");
  await attempt(async () => {
    const { reopen } = await import("../session/index.js");
    if (await reopen(listed)) return;
    if (listed.frames !== undefined) {
      const { openVideo, trackAll } = await import("../alignment/video.js");
      if (await openVideo(listed)) await trackAll();
      return;
    }
    const { acceptIfClear, proposeScenes } = await intake();
    await proposeScenes([listed]);
    await acceptIfClear();
  });
}

/** How far the work on a scene of the list is. */
export function progressOf({ inputs: { id }, progress }: Listed): Progress | null {
  return id !== inputs.value.id || scene.value === null || video.value !== null ? progress : progressIn(objects.value);
}

/** Whether a scene is of this kind. One that was aligned in vain is in doubt, too. */
export function isOfKind(one: Listed, kind: SceneKind): boolean {
  const { state = "to do" } = progressOf(one) ?? {};
  if (kind === "doubtful")
    return state === "unsure" || state === "check files" || (state === "to do" && one.progress !== null);
  return kind === "any" || state !== "decided";
}

/** The scenes in the order in which they are listed. */
export function orderedList(): readonly Listed[] {
  const sureness = (one: Listed) => (isOfKind(one, "open") ? (progressOf(one)?.confidence ?? 0) : 2);
  return page.listed.value.isSorted ? [...list.value].sort((a, b) => sureness(a) - sureness(b)) : list.value;
}

/** The next scene of the list that is of this kind, after the one that is shown. */
export function nextListed(kind: SceneKind): Inputs | null {
  const all = orderedList();
  const at = all.findIndex((one) => one.inputs.id === inputs.value.id);
  return [...all.slice(at + 1), ...all.slice(0, Math.max(at, 0))].find((one) => isOfKind(one, kind))?.inputs ?? null;
}

/**
 * Shows a later frame of the video that waits for a person or, for this kind, is not decided on; without any, the next scene of
 * this kind.
 */
function openNext(kind: NextKind): boolean {
  const { frameIndex, framePoses } = page;
  const isWaiting = (pose: FramePose | null, i: number) => {
    const verdict = page.frameWorks.peek()[i]?.verdict ?? null;
    return i > frameIndex.peek() && (kind === "frame" ? verdict === null : isFrameDoubtful(pose, verdict));
  };
  const frame = framePoses.peek().findIndex(isWaiting);
  if (frame >= 0) attempt(async () => (await import("../alignment/video.js")).showFrame(frame));
  const next = frame < 0 && kind !== "frame" ? nextListed(kind) : null;
  if (next !== null) openListed(next);
  return frame >= 0 || next !== null;
}

/** Shows the next scene of the list or, without any, the first sample. */
async function openAnother(): Promise<void> {
  const [first] = samples;
  const next = nextListed("open") ?? nextListed("any");
  if (next !== null) await openListed(next);
  else if (first !== undefined && (await openSample(first))) await alignAll(page);
}

page.fileActions.value = {
  ...{ edit: editInputs, change: changeInputs, correct: correctMask, next: openNext, another: openAnother },
  words: messageOf,
};

Object.assign(onPage, {
  COMPRESSED_MESH: "Export the mesh without compression.",
  CORRUPT_FILE: "Export or download the file again.",
  EIGHT_BIT_DEPTH: "Choose the depth map as the camera or the model wrote it.",
  FILE_TOO_LARGE: "Choose a smaller file.",
  INVALID_CAMERA: "Choose another camera file, or enter the numbers.",
  NO_DEPTH_IN_MASK: "Choose the mask and the depth map of one view, or flip the sign of the depth.",
  SIZE_MISMATCH: "Choose the files of one view.",
  UNSUPPORTED_FORMAT: "Save the file in another format, and choose it again.",
  WRONG_LENGTH: "Choose a file of one image.",
} satisfies typeof onPage);
