/** What the steps of a scene hand over to one another; see `modules/joint/src/scene.rs`. */
import type { Alignment, Contact } from "../generated/types.js";

/** The space that an object takes: for each pixel of a part of the image, where the line of sight enters and leaves it. */
export interface Layer {
  origin: [number, number];
  layerWidth: number;
  spans: Float32Array;
}

/** What the search of an object has found. */
export interface Placement extends Layer {
  found: Float64Array;
  effort: string;
  renders: number;
  confidence: number;
  matrix: Float64Array;
  points: Float32Array;
  /** Its extent along the normal of the ground, metres. */
  along: [number, number] | null;
}

/** The plane that an object may stand on; a number is the index of the object whose top it is. */
export interface Ground {
  normal: [number, number, number];
  d: number;
  gapM: number;
  on: "support" | "level" | number;
}

/** What an object is told about the others. */
export interface Known {
  placement: Placement;
  ground: Ground | null;
  layers: Layer[];
}

/** The result of a step of an object; the alignment belongs to the last one. */
export interface Placed {
  placement: Placement;
  alignment?: Alignment;
}

/** The support of a scene, and what each object may stand on. */
export interface Supported {
  support: { normal: [number, number, number]; d: number; confidence: number } | null;
  grounds: (Ground | null)[];
}

/** The contact of each object; `null` for one without a pose. */
export type Contacts = (Contact | null)[];
