/** Notes on the files of an input, and their warnings, in its result. */
import type { Warning } from "../generated/types.js";
import type { InputNotes } from "../types/results.js";
import { fromOrigin } from "./origin.js";

/** The readings of the files of a view. */
export function sourcesOf(notes: InputNotes) {
  const { warnings: _, doubts: __, unread: ___, colors: ____, origin: _____, ...sources } = notes;
  return sources;
}

/** Confidence below which a pose is in doubt. */
export const DOUBT = 0.5;

/**
 * Warnings that the input is likely not what it is taken for. A pose that fits it is as likely wrong as right, however well it fits:
 * with these, the confidence is at most {@link DOUBT}.
 */
const DOUBTED_INPUT: ReadonlySet<Warning["code"]> = new Set<Warning["code"]>([
  ...(["CAMERA_DOUBTFUL", "CAMERA_NOT_PINHOLE", "SIZE_DOUBTFUL"] as const),
  ...([
    "DEPTH_LOOKS_LIKE_MILLIMETRES",
    "DEPTH_LOOKS_TOO_SMALL",
    "DEPTH_LOOKS_NORMALISED",
    "DEPTH_LOOKS_CODED",
  ] as const),
  ...(["DEPTH_LOOKS_LIKE_BACKGROUND", "MESH_LOOKS_MIRRORED"] as const),
]);

/** A result whose confidence takes account of these warnings on its input. */
export function withDoubts<T extends { confidence?: number }>(result: T, warnings: readonly Warning[]): T {
  const { confidence } = result;
  const isDoubted = confidence !== undefined && warnings.some(({ code }) => DOUBTED_INPUT.has(code));
  return isDoubted ? { ...result, confidence: Math.min(confidence, DOUBT) } : result;
}

/** Labels may be parts of an object: a pose that is not in doubt shows that they are. */
const labels: Warning = {
  code: "MASK_HAS_LABELS",
  message:
    "The mask has several labels, and all of them were read as one object. Pass a mask of the object's label alone, or the whole map as labels of alignScene.",
};

/** Warnings about lengths say where the unit of the depth comes from. */
const withUnit =
  ({ depthUnit }: InputNotes) =>
  (warning: Warning): Warning => {
    if (!["DEPTH_LOOKS_LIKE_MILLIMETRES", "DEPTH_LOOKS_TOO_SMALL", "SIZE_DOUBTFUL"].includes(warning.code))
      return warning;
    const { metres = null, source, isAssumed } = depthUnit ?? {};
    if (metres === null) return warning;
    const origin = `${isAssumed ? "is assumed" : "is stated"} (${source})`;
    return { ...warning, message: `${warning.message} The unit, ${Number(metres.toPrecision(6))} m, ${origin}.` };
  };

/** A result with the notes on its files; their warnings before those of the core. */
export function withNotes<T extends { warnings: Warning[]; confidence?: number; shapeConfidence?: number }>(
  result: T,
  notes: InputNotes,
): T {
  const ofColors = notes.colors.map((message) => ({ code: "COLORS_NOT_READ", message }) as const);
  const ofContent = notes.unread.map((message) => ({ code: "CONTENT_NOT_READ", message }) as const);
  // Of a unit that is stated, no size is doubtful.
  const ofCore = result.warnings.filter(({ code }) => code !== "SIZE_DOUBTFUL" || notes.depthUnit?.isAssumed === true);
  const { confidence, shapeConfidence = confidence } = result;
  const isDoubtful = (shapeConfidence ?? 0) < DOUBT;
  const hasLabels = notes.maskReading?.endsWith(": labels") === true && isDoubtful;
  const isInDoubt = isDoubtful && typeof confidence === "number";
  const ofDoubt = [...(isInDoubt ? (notes.doubts ?? []) : []), ...(hasLabels ? [labels] : [])];
  const warnings = [...notes.warnings, ...ofDoubt, ...ofContent, ...ofColors, ...ofCore.map(withUnit(notes))];
  const found = { ...fromOrigin(result, notes.origin), ...sourcesOf(notes), warnings };
  return withDoubts(found, warnings);
}
