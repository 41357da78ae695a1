/** How far the work on a scene is. */

import type { ObjectModel } from "./object-model.js";

/** From this confidence on, a result needs no remedy, and a pose no second look. */
export const SURE = 0.9;

/** What is to be done with a scene: an unsure one has a pose that is neither accepted nor found with certainty. */
export type ProgressState = "to do" | "aligned" | "unsure" | "accepted";

export interface Progress {
  readonly objects: number;
  /** Objects whose poses are accepted. */
  readonly accepted: number;
  readonly state: ProgressState;
}

/** What counts of an object. */
interface Judged {
  readonly isPlaced: boolean;
  readonly isAccepted: boolean;
  /** That of the present pose; null for one that no alignment has found. */
  readonly confidence: number | null;
}

export function progressOf(objects: readonly Judged[]): Progress {
  const open = objects.filter(({ isAccepted }) => !isAccepted);
  const state =
    open.length === 0
      ? "accepted"
      : open.some(({ isPlaced }) => !isPlaced)
        ? "to do"
        : open.some(({ confidence }) => (confidence ?? 0) < SURE)
          ? "unsure"
          : "aligned";
  return { objects: objects.length, accepted: objects.length - open.length, state };
}

/** The same of objects in their present state. */
export const progressIn = (objects: readonly ObjectModel[]): Progress =>
  progressOf(
    objects.map(({ confidence, isAccepted, isPlaced }) => ({ confidence, isPlaced, isAccepted: isAccepted.value })),
  );
