/** What was done with objects, as plain data. */
import { toSim3 } from "sim3align/conventions/similarity";
import type { AnyAlignment, ObjectModel, Verdict } from "./object-model.js";
import type { PoseSource } from "./pose.js";

/** What was done with an object. */
export interface ObjectWork {
  matrix: readonly number[];
  source: PoseSource;
  alternative?: number | undefined;
  verdict?: Verdict | null;
  comment?: string;
  isShown: boolean;
  isLocked: boolean;
  knownScale: number | null;
  alignment: AnyAlignment | null;
}

/** What was done with an object. */
export function stateOf(object: ObjectModel): ObjectWork {
  const { alignment, comment, isLocked, isShown, knownScale, pose, verdict } = object;
  const { transform, source, alternative } = pose.value;
  return {
    ...{ matrix: [...transform.matrix], source, alternative },
    ...{ verdict: verdict.value, comment: comment.value, isShown: isShown.value, isLocked: isLocked.value },
    ...{ knownScale: knownScale.value, alignment: alignment.value },
  };
}

/** The decision that was stored. */
export const verdictOf = (state: ObjectWork | null): Verdict | null => state?.verdict ?? null;

/** Gives an object the pose, the decision and the settings that were stored. */
export function applyToObject(state: ObjectWork, object: ObjectModel): void {
  const { matrix, source, alternative, alignment, comment = "" } = state;
  const verdict = verdictOf(state);
  const pose = { transform: toSim3(matrix), source, alignment, ...(alternative !== undefined && { alternative }) };
  object.run.value = { state: alignment === null ? "idle" : "done" };
  // The pose of an object that was not aligned is the one before any alignment, in the present calibration.
  if (source !== "start") object.pose.value = pose;
  object.decision.value = verdict === null ? null : { verdict, pose: object.pose.peek() };
  object.comment.value = comment;
  object.isShown.value = state.isShown;
  object.isLocked.value = state.isLocked;
  object.knownScale.value = state.knownScale;
}
