/** The input and the result of `alignScene`. */

import type * as Core from "../generated/types.js";
import type { Sim3AlignError } from "../values/error.js";
import type { PixelArray } from "../values/pixels.js";
import type { DepthView, MaskInput, MeshInput } from "./inputs.js";
import type { AlignOptions, Progress } from "./options.js";
import type { Alignment, InputInfo } from "./results.js";

/** A plane n·x + d = 0 in the OpenCV camera frame, metres; n points to the side of the objects. */
export interface Plane {
  /** n, of any length above 0 as an argument, of length 1 in results. */
  normal: readonly [x: number, y: number, z: number];
  /** d. In results, the height of the camera over the plane, in metres. */
  d: number;
}

/** An object of a scene: its mask or its label, its mesh, and what is known of it, which goes before the options. */
export interface SceneObjectInput
  extends Pick<
    AlignOptions,
    "scale" | "knownExtentM" | "knownExtentAxis" | "meshUp" | "cameraUp" | "symmetry" | "initial" | "search" | "quality"
  > {
  /** The name of the object in the result. */
  name?: string | undefined;
  /** The mask of the object. Omit it if the scene has a label map. */
  mask?: MaskInput | undefined;
  /** The value of its pixels in the label map. */
  label?: number | undefined;
  /** How to resize a mask whose size differs from that of the depth map. By default, such a mask is an error. */
  resizeMask?: "nearest" | undefined;
  /** The place of the mask in a JSON file of several, from 0. */
  maskIndex?: number | undefined;
  /** The mesh to align. */
  mesh: MeshInput;
}

/** One image in which each object has a value of its own; 0 is no object. */
export type LabelMap = PixelArray<Uint8Array | Uint8ClampedArray | Uint16Array | Uint32Array>;

/** The input of `alignScene`: what a camera saw, as for `align`, and the objects. */
export type SceneInput = DepthView & {
  /** The objects with a mesh. */
  objects: readonly SceneObjectInput[];
  /** The label map that the labels of the objects refer to. Other labels are occluders. */
  labels?: LabelMap | undefined;
  /** Masks of objects without a mesh. They hide what is behind them. */
  occluders?: readonly MaskInput[] | undefined;
  /** The plane that objects stand on: found in the depth map (`"auto"`, the default), known, or none (`null`). */
  support?: "auto" | Plane | null | undefined;
};

/** Options of `Aligner.alignScene`: those of `align`, for every object. */
export interface SceneOptions extends Omit<AlignOptions<boolean>, "onProgress" | "initial" | "transfer"> {
  /**
   * Moves each object that touches something along the normal of the support, so that it touches it exactly. The
   * pose says so; the metrics are those of the pose before. Default `false`.
   */
  snap?: boolean | undefined;
  /** Like `onProgress` of `align`: the fraction is that of the scene, `index` the object. */
  onProgress?: ((progress: Progress & { index: number }) => void) | undefined;
}

/** An object of a scene, aligned. */
export interface SceneAlignment extends Omit<Alignment, "input" | keyof InputInfo>, Pick<InputInfo, "maskReading"> {
  /** The name of the input. */
  name?: string;
  /** What it rests on. */
  contact: Core.Contact;
  error?: undefined;
}

/** An object of a scene that could not be aligned; the others are. */
export interface SceneFailure {
  /** The name of the input. */
  name?: string;
  /** Why. */
  error: Sim3AlignError;
}

/** The plane that the objects stand on. */
export interface Support extends Plane {
  normal: [x: number, y: number, z: number];
  /** How much of the scene agrees that things stand on it, 0 to 1; 1 for a plane that was given. */
  confidence: number;
}

/** Measures of a whole scene. */
export type SceneMetrics = {
  /** Number of aligned objects. */
  aligned: number;
  /** Number of these that rest on the support or on another object. */
  resting: number;
  /** Median of the absolute gaps of the objects that rest on something, in metres; `null` if none does. */
  medianGapM: number | null;
  /** Mean share of an object's volume that is inside others, 0 to 1. */
  sharedVolume: number;
};

/** The result of `alignScene`. */
export interface SceneResult extends InputInfo {
  /** In the order of the input. */
  objects: (SceneAlignment | SceneFailure)[];
  /** What the objects stand on; `null` if nothing in the depth map is a plane that they touch. */
  support: Support | null;
  /** Measures of the scene. */
  metrics: SceneMetrics;
  /** Conditions that concern the view; those of an object are its own. */
  warnings: Core.Warning[];
}
