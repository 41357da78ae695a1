/** The results of alignments. */
import type { AlignmentByPreset, Contact } from "sim3align";

/** The result of an alignment, with any preset. The result of a scene also says what the object rests on. */
export type AnyAlignment = (PreciseAlignment | Omit<AlignmentByPreset["paper"], "input">) & {
  readonly contact?: Contact;
};

/** The result with the preset `precise`. */
export type PreciseAlignment = Omit<AlignmentByPreset["precise"], "input">;
