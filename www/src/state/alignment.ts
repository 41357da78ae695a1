/** The results of alignments. */
import type { Alignment, Contact, PaperAlignment } from "sim3align";

/** The result of an alignment, with any preset. The result of a scene also says what the object rests on. */
export type AnyAlignment = (PreciseAlignment | Omit<PaperAlignment, "input">) & {
  readonly contact?: Contact;
};

/** The result with the preset `precise`. */
export type PreciseAlignment = Omit<Alignment, "input">;
