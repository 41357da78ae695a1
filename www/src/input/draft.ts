/** The draft: the inputs of a scene that is not shown yet. Nothing else of the page refers to them. */
import { signal } from "@preact/signals";
import type { Inputs, Typed } from "../state/inputs.js";
import type { Problem } from "./problems.js";
import type { Reading, ReadingProgress } from "./reading.js";

export interface Draft {
  /** The scenes of the drop, of which one is looked at. */
  scenes: readonly Inputs[];
  index: number;
  /** Null while the files are being read. */
  reading: Reading | null;
  /** How much of it is read. */
  progress: ReadingProgress;
  problems: readonly Problem[];
  /** Whether the scenes are the frames of one video. */
  isVideo: boolean;
  /** Whether these are the inputs of the scene that is shown already. */
  isEdit: boolean;
  /** The index of the object whose mask it corrects: it is opened once that is done. */
  corrects?: number;
  /** Files that may belong to the scene that is shown: whether they do is asked. */
  forShown?: readonly Typed[];
}

export const draft = signal<Draft | null>(null);

/** The index of the object whose mask is being marked; null for none. */
export const marked = signal<number | null>(null);

/** The doubts that a person has seen and left as they are: the other scenes of a drop mostly have the same ones. */
export const seenDoubts = new Set<string>();

/** The inputs that the draft is about. */
export const draftInputs = ({ scenes, index }: Draft): Inputs => scenes[index] as Inputs;

/** Whether the draft can become the scene. */
export const isReady = ({ reading, problems }: Draft): boolean =>
  reading !== null && !problems.some(({ kind }) => kind === "error");
