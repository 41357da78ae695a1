/** The other poses that explain the picture. */
import { toSim3 } from "sim3align/conventions";
import { place } from "../state/history.js";
import type { ObjectModel } from "../state/object-model.js";

/** Puts the mesh at an alternative, or with −1 back to the result. */
export function applyAlternative(object: ObjectModel, index: number): void {
  const alignment = object.alignment.peek();
  if (alignment === null) return;
  const found = index < 0 ? alignment : alignment.alternatives[index];
  if (found === undefined) return;
  const transform = toSim3(found);
  place(
    object,
    index < 0 ? { transform, source: "aligned" } : { transform, source: "alternative", alternative: index },
  );
}

/** Which of the poses is shown: −1 is the result, null is none of them. */
export function shownAlternative(object: ObjectModel): number | null {
  const { source, alternative } = object.pose.value;
  if (source === "alternative") return alternative ?? null;
  return source === "aligned" || source === "refined" ? -1 : null;
}
