/** The events of an element, from the changes of its workspace. */
import { effect, untracked } from "@preact/signals";
import { Sim3AlignError } from "sim3align";
import type { ObjectModel } from "../state/object-model.js";
import type { Workspace } from "../state/workspace.js";
import { poseOf, resultOf } from "./results.js";
import type { ElementEvents } from "./sim3-align.js";

export type Send = <K extends keyof ElementEvents>(type: K, detail: ElementEvents[K]) => void;

/** The detail of an error. */
export const errorDetail = (cause: unknown, name: string | null = null): ElementEvents["error"] => ({
  message: cause instanceof Error ? cause.message : `${cause}`,
  name,
  code: cause instanceof Sim3AlignError ? cause.code : null,
});

/** Sends the events of a workspace, until the returned function is called. */
export function sendEvents(workspace: Workspace, send: Send): () => void {
  const { fraction, isRunning, objects } = workspace;
  let wasRunning = false;
  const stops = [
    effect(() => {
      if (isRunning.value) send("progress", { fraction: fraction.value });
    }),
    effect(() => {
      const isNow = isRunning.value;
      const hasEnded = wasRunning && !isNow;
      wasRunning = isNow;
      if (hasEnded) untracked(() => sendEnd(workspace, send));
    }),
    effect(() => {
      const ofObjects = objects.value.flatMap((object) => untracked(() => sendChanges(workspace, object, send)));
      return () => {
        for (const stop of ofObjects) stop();
      };
    }),
  ];
  return () => {
    for (const stop of stops) stop();
  };
}

function sendEnd(workspace: Workspace, send: Send): void {
  const states = workspace.objects.peek().map((object) => [object, object.run.peek()] as const);
  for (const [object, run] of states) if (run.state === "failed") send("error", errorDetail(run.error, object.name));
  const done = states.filter(([, run]) => run.state === "done").map(([object]) => resultOf(workspace, object));
  if (done.length > 0) send("align", { objects: done });
}

function sendChanges(workspace: Workspace, object: ObjectModel, send: Send): (() => void)[] {
  const { pose, isAccepted, name } = object;
  let [shown, wasAccepted] = [pose.peek(), isAccepted.peek()];
  return [
    pose.subscribe((next) => {
      if (next !== shown) send("posechange", { name, pose: poseOf(object), source: next.source });
      shown = next;
    }),
    isAccepted.subscribe((is) => {
      if (is !== wasAccepted) send("accept", resultOf(workspace, object));
      wasAccepted = is;
    }),
  ];
}
