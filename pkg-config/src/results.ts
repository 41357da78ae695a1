/** What the calls return: plain objects; `null` stands for what could not be measured. */
import type { Sim3AlignError } from "./error.js";
import type * as Core from "./generated/types.js";
import type { AlignInput } from "./input/types.js";
import { type Sim3, withTypedMatrix } from "./sim3.js";

/** The kinds of warning. */
export type WarningCode =
  | Core.WarningCode
  /** The camera file says more than a pinhole camera can: lens distortion. */
  | "CAMERA_NOT_PINHOLE";

/** Something about the input that the caller should know; the result stands. */
export interface Warning extends Omit<Core.Warning, "code"> {
  /** A stable name. */
  code: WarningCode;
}

/** Another pose that explains the observation: a transform like the alignment's own. */
export interface Alternative extends Sim3, Omit<Core.Alternative, keyof Core.Sim3> {}

/**
 * What `align` found: the transform from the mesh's frame to the camera's, x_cam = s·R·p_mesh + t (OpenCV camera: x
 * right, y down, z forward; metres).
 */
export interface Alignment extends Sim3, Omit<Core.Alignment, keyof Core.Sim3 | "alternatives" | "warnings"> {
  /**
   * `precise`: other poses that explain the observation nearly as well, best first: flips, and symmetries that the
   * object has and the mesh has not. Empty where none comes near, and for `paper`.
   */
  alternatives: Alternative[];
  /** What the caller should know about the input. */
  warnings: Warning[];
  /** With `transfer: true`: the input, handed back. */
  input?: AlignInput;
}

/** What `evaluate` found. */
export interface Evaluation extends Omit<Core.Evaluation, "warnings"> {
  /** What the caller should know about the input. */
  warnings: Warning[];
  /** With `transfer: true`: the input, handed back. */
  input?: AlignInput;
}

/** What `register` and `estimateSim3` found: target from source, y = s·R·x + t. */
export interface Registration extends Sim3, Omit<Core.Registration, keyof Core.Sim3> {
  /** With `transfer: true`: the clouds, and the correspondences, handed back. */
  input?: Clouds;
}

/** Two clouds, x, y, z one after the other, and for `estimateSim3` which of their points belong together. */
export interface Clouds {
  source: Float32Array | Float64Array;
  target: Float32Array | Float64Array;
  correspondences?: Uint32Array;
}

/** One of the results of `alignAll`: an alignment, or what prevented it. */
export type AlignAllResult =
  | { index: number; alignment: Alignment; input?: AlignInput; error?: undefined }
  | { index: number; alignment?: undefined; input?: AlignInput; error: Sim3AlignError };

/** The core's alignment with its matrices as typed arrays. */
export function alignmentOf(result: Core.Alignment): Omit<Alignment, "warnings"> & { warnings: Core.Warning[] } {
  return { ...withTypedMatrix(result), alternatives: result.alternatives.map(withTypedMatrix) };
}

/** A result with the input's own warnings before those of the core. */
export function withWarnings<T extends { warnings: Core.Warning[] }>(
  result: T,
  messages: readonly string[],
): T & { warnings: Warning[] } {
  const warnings = messages.map((message): Warning => ({ code: "CAMERA_NOT_PINHOLE", message }));
  return { ...result, warnings: [...warnings, ...result.warnings] };
}
