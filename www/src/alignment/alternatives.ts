/** Shows the alternatives of an alignment. */
import { toSim3 } from "sim3align/conventions";
import type { ObjectModel } from "../state/object-model.js";
import { isResult } from "../state/pose.js";
import type { Workspace } from "../state/workspace.js";

/** Sets the pose to an alternative, or with −1 to the result. */
export function applyAlternative({ place }: Workspace, object: ObjectModel, index: number): void {
  const alignment = object.alignment.peek();
  if (alignment === null) return;
  const chosen = index < 0 ? alignment : object.precise?.alternatives[index];
  if (chosen === undefined) return;
  const transform = toSim3(chosen);
  place(
    object,
    index < 0
      ? { transform, source: "aligned", alignment }
      : { transform, source: "alternative", alternative: index, alignment },
  );
}

/** The index of the alternative that is shown: −1 is the result, null is another pose. */
export function shownAlternative(object: ObjectModel): number | null {
  const { source, alternative } = object.pose.value;
  if (source === "alternative") return alternative ?? null;
  return isResult(source) ? -1 : null;
}
