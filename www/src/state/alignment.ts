/** The results of alignments. */
import type { Alignment, PaperAlignment, SceneAlignment } from "sim3align";

/** Whether the unit of the depth map was assumed, and gives the object an unusual size. */
export const hasSizeDoubt = (alignment: AnyAlignment | null): boolean =>
  alignment?.warnings.some(({ code }) => code === "SIZE_DOUBTFUL") === true;

/** The result of an alignment, with any preset. The result of a scene also says what the object rests on. */
export type AnyAlignment = (PreciseAlignment | Omit<PaperAlignment, "input">) & {
  readonly contact?: SceneAlignment["contact"];
};

/** The result with the preset `precise`. */
export type PreciseAlignment = Omit<Alignment, "input">;
