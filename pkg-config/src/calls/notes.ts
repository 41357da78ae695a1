/** Notes on the files of an input, and their warnings, in its result. */
import type { Warning } from "../generated/types.js";
import type { InputNotes } from "../types/results.js";
import { fromOrigin } from "./origin.js";

/** The readings of the files of a view. */
export const sourcesOf = ({ warnings: _, unread: __, colors: ___, origin: ____, ...sources }: InputNotes) => sources;

/** Confidence below which a pose is in doubt. */
export const DOUBT = 0.5;

/** Labels may be parts of an object: a pose that is not in doubt shows that they are. */
const labels: Warning = {
  code: "MASK_HAS_LABELS",
  message:
    "The mask has several labels, and all of them were read as one object. Pass a mask of the object's label alone, or the whole map as labels of alignScene.",
};

/** A result with the notes on its files; their warnings before those of the core. */
export function withNotes<T extends { warnings: Warning[]; confidence?: number | null }>(
  result: T,
  notes: InputNotes,
): T {
  const ofColors = notes.colors.map((message) => ({ code: "COLORS_NOT_READ", message }) as const);
  const ofContent = notes.unread.map((message) => ({ code: "CONTENT_NOT_READ", message }) as const);
  // Of a unit that is stated, no size is doubtful.
  const ofCore = result.warnings.filter(({ code }) => code !== "SIZE_DOUBTFUL" || notes.depthUnit?.isAssumed === true);
  const hasLabels = notes.maskReading?.endsWith(": labels") === true && (result.confidence ?? 0) < DOUBT;
  const warnings = [...notes.warnings, ...(hasLabels ? [labels] : []), ...ofContent, ...ofColors, ...ofCore];
  return { ...fromOrigin(result, notes.origin), ...sourcesOf(notes), warnings };
}
