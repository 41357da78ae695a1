/** The queue: scenes of the list that were not opened yet are aligned in the background, so that none has to be waited for. */
import { effect, signal, untracked } from "@preact/signals";
import { alignAll } from "../alignment/align.js";
import { observePoses } from "../alignment/evaluate.js";
import { isTracking } from "../alignment/video.js";
import { draft, seenDoubts } from "../input/draft.js";
import { readInputs, sceneOf } from "../input/reading.js";
import { keep, setProgress } from "../session/index.js";
import type { Inputs } from "../state/inputs.js";
import { page } from "../state/page.js";
import { createWorkspace } from "../state/workspace.js";
import { problemsOf } from "./checks.js";

const { inputs, isReading, isRunning, list, options } = page;

/** The scene that is aligned in the background. */
const behind = createWorkspace({ theme: page.theme });
const isWorking = signal(false);

/** Keeps the queue running. It gives way to everything that a person does. */
export function runAhead(): void {
  observePoses(behind);
  effect(() => {
    const isBusy = isRunning.value || isReading.value || isTracking.value || draft.value !== null;
    const next = nextWaiting();
    if (isBusy) behind.cancel();
    else if (next !== undefined && !isWorking.value) untracked(() => work(next));
  });
}

/** The scene that is likely to be looked at next: one after the scene that is shown. */
function nextWaiting(): Inputs | undefined {
  const all = list.value;
  const at = all.findIndex((one) => one.inputs.id === inputs.value.id);
  return [...all.slice(at + 1), ...all.slice(0, at + 1)].find(isWaiting)?.inputs;
}

const isWaiting = ({ inputs: { frames, id }, progress }: ReturnType<typeof list.peek>[number]) =>
  progress === null && frames === undefined && id !== inputs.value.id;

async function work(from: Inputs): Promise<void> {
  isWorking.value = true;
  try {
    await align(from);
  } finally {
    behind.scene.value = null;
    isWorking.value = false;
  }
}

async function align(from: Inputs): Promise<void> {
  const reading = await readInputs(from);
  const opened = sceneOf(from, reading);
  // What a person has to look at is not passed over.
  const isClear = problemsOf(from, reading).every(({ kind, message }) => kind === "doubt" && seenDoubts.has(message));
  if (opened === null || !isClear) {
    const objects = from.objects.length;
    return setProgress(from.id, { objects, state: "check files", decided: 0, accepted: 0, confidence: null });
  }
  behind.options.value = options.peek();
  behind.show(opened, from, false);
  if (isRunning.peek()) return;
  await alignAll(behind);
  const isCancelled = opened.objects.some(({ run }) => run.peek().state === "cancelled");
  const isThere = list.peek().some((one) => one.inputs.id === from.id && isWaiting(one));
  const settings = { options: options.peek(), support: behind.support.peek() };
  if (!isCancelled && isThere && behind.scene.peek() !== null) keep(from, behind.scene.peek(), settings, false);
}
