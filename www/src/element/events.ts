/** The events of an element, from the changes of its workspace. */
import { effect, untracked } from "@preact/signals";
import { Sim3AlignError } from "sim3align";
import type { ObjectModel } from "../state/object-model.js";
import type { Workspace } from "../state/workspace.js";
import { type ObjectResult, type PlainPose, plainPose, resultOf } from "./results.js";

/** The details of the events. */
export interface ElementEvents {
  /** A scene is shown. */
  ready: { name: string; objects: string[] };
  /** 0 to 1, while objects are being aligned. */
  progress: { fraction: number };
  /** An alignment or a refinement has ended. */
  align: { objects: ObjectResult[] };
  /** A pose has changed: by an alignment, by hand (with every step of a drag), or by an alternative. */
  posechange: { name: string; pose: PlainPose; source: string };
  /** A person has accepted a pose, or a change has made it open again. */
  accept: ObjectResult;
  /** A scene could not be read, or an object not be aligned. */
  error: { message: string; name: string | null; code: string | null };
}

export type Send = <K extends keyof ElementEvents>(type: K, detail: ElementEvents[K]) => void;

/** The detail of an error. */
export const errorDetail = (cause: unknown, name: string | null = null): ElementEvents["error"] => ({
  message: cause instanceof Error ? cause.message : `${cause}`,
  name,
  code: cause instanceof Sim3AlignError ? cause.code : null,
});

/** Sends the events of a workspace, until the returned function is called. */
export function sendEvents(workspace: Workspace, send: Send): () => void {
  const { fraction, isRunning, scene } = workspace;
  let wasRunning = false;
  let ofObjects: (() => void)[] = [];
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
      for (const stop of ofObjects) stop();
      ofObjects = (scene.value?.objects ?? []).flatMap((object) => untracked(() => sendChanges(object, send)));
    }),
  ];
  return () => {
    for (const stop of [...stops, ...ofObjects]) stop();
  };
}

function sendEnd({ scene }: Workspace, send: Send): void {
  const objects = scene.peek()?.objects ?? [];
  const states = objects.map((object) => [object, object.run.peek()] as const);
  for (const [object, run] of states) if (run.state === "failed") send("error", errorDetail(run.error, object.name));
  const done = states.filter(([, run]) => run.state === "done").map(([object]) => resultOf(object));
  if (done.length > 0) send("align", { objects: done });
}

function sendChanges(object: ObjectModel, send: Send): (() => void)[] {
  const { pose, isAccepted, name } = object;
  let [shown, wasAccepted] = [pose.peek(), isAccepted.peek()];
  return [
    pose.subscribe((next) => {
      if (next !== shown) send("posechange", { name, pose: plainPose(object), source: next.source });
      shown = next;
    }),
    isAccepted.subscribe((is) => {
      if (is !== wasAccepted) send("accept", resultOf(object));
      wasAccepted = is;
    }),
  ];
}
