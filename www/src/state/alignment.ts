/** The results of alignments. */
import type { Alignment, PaperAlignment, SceneAlignment } from "sim3align";

/** What a person must check, however sure the search is: see {@link doubtOf}. */
export type Doubt = "size" | "turn";

/** Below this confidence in the choice among turns of equal shape, the turn needs a second look. */
const SURE_OF_TURN = 0.7;

/**
 * The size, if the unit of the depth map was assumed and gives the object an unusual one; the turn, if neither shape nor
 * colours decide it.
 */
export function doubtOf(alignment: AnyAlignment | null): Doubt | null {
  if (alignment?.warnings.some(({ code }) => code === "SIZE_DOUBTFUL") === true) return "size";
  const turn = alignment !== null && "turnConfidence" in alignment ? alignment.turnConfidence : null;
  return turn !== null && turn < SURE_OF_TURN ? "turn" : null;
}

/** The result of an alignment, with any preset. The result of a scene also says what the object rests on. */
export type AnyAlignment = (PreciseAlignment | Omit<PaperAlignment, "input">) & {
  readonly contact?: SceneAlignment["contact"];
};

/** The result with the preset `precise`. */
export type PreciseAlignment = Omit<Alignment, "input">;
