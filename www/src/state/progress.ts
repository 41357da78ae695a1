/** How far the work on a scene is. */

import type { Doubt, ObjectModel, Verdict } from "./object-model.js";
import type { FramePose } from "./video.js";

/** From this confidence on, a result needs no remedy, and a pose no second look. */
export const SURE = 0.9;

/**
 * What is to be done with a scene: the files of one to check have a problem, and an unsure one has a pose that is neither
 * decided on nor found with certainty.
 */
export type ProgressState = "to do" | "check files" | "aligned" | "unsure" | "decided";

export interface Progress {
  /** The number of objects, or of the frames of a video. */
  readonly objects: number;
  readonly decided: number;
  readonly accepted: number;
  readonly state: ProgressState;
  /** The lowest of those that are open. */
  readonly confidence: number | null;
}

/** What counts of an object. */
export interface Judged {
  readonly isPlaced: boolean;
  readonly verdict: Verdict | null;
  /** That of the present pose; null for one that no alignment has found. */
  readonly confidence: number | null;
  readonly doubt?: Doubt | null;
}

/** Whether an object waits for a person: nothing is decided, and the search, the unit or the turn is not sure. */
export const isDoubtful = ({ verdict, confidence, doubt = null }: Judged): boolean =>
  verdict === null && ((confidence ?? 0) < SURE || doubt !== null);

export function progressOf(objects: readonly Judged[], hasDoubt = objects.some(isDoubtful)): Progress {
  const open = objects.filter(({ verdict }) => verdict === null);
  const state =
    open.length === 0 ? "decided" : open.some(({ isPlaced }) => !isPlaced) ? "to do" : hasDoubt ? "unsure" : "aligned";
  const known = open.flatMap(({ confidence }) => confidence ?? []);
  return {
    ...{ state, objects: objects.length, decided: objects.length - open.length },
    accepted: objects.filter(({ verdict }) => verdict === "accepted").length,
    confidence: known.length === 0 ? null : Math.min(...known),
  };
}

export const judged = ({ confidence, doubt, isPlaced, verdict }: ObjectModel): Judged => ({
  ...{ confidence, doubt, isPlaced, verdict: verdict.value },
});

/** The same of objects in their present state. */
export const progressIn = (objects: readonly ObjectModel[]): Progress => progressOf(objects.map(judged));

/** Whether a frame waits for a person: the tracker says so, and nothing is decided. */
export const isFrameDoubtful = (pose: FramePose | null, verdict: Verdict | null): boolean =>
  verdict === null && pose !== null && !pose.isCorrected && pose.state !== "tracking";

/** The same of the frames of a video. */
export function progressOfFrames(
  poses: readonly (FramePose | null)[],
  verdicts: readonly (Verdict | null)[],
): Progress {
  const verdictOf = (i: number) => verdicts[i] ?? null;
  const frames = poses.map((pose, i) => ({
    ...{ isPlaced: pose !== null, verdict: verdictOf(i), confidence: pose?.confidence ?? null },
  }));
  return progressOf(
    frames,
    poses.some((pose, i) => isFrameDoubtful(pose, verdictOf(i))),
  );
}
