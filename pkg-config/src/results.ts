/**
 * Results of the calls: plain objects, which `JSON.stringify` writes completely. `null` marks a value that could not be
 * measured.
 */
import type { Sim3AlignError } from "./error.js";
import type * as Core from "./generated/types.js";
import type { FrameInput, ViewsInput } from "./input/frame-types.js";
import type { AlignInput } from "./input/types.js";

/** The result of `align`: camera from mesh, x_cam = s·R·p_mesh + t (OpenCV: x right, y down, z forward; metres). */
export interface Alignment extends Core.Alignment {
  /** With `transfer: true`: the returned arrays of the input. */
  input?: AlignInput;
}

/** The result of `align` with `preset: "paper"`. */
export interface PaperAlignment extends Core.PaperAlignment {
  /** With `transfer: true`: the returned arrays of the input. */
  input?: AlignInput;
}

/** A result of a call with `metrics: false`. */
export type WithoutMetrics<T> = Omit<T, "metrics"> & { metrics?: undefined };

/** The result of each preset. */
export interface AlignmentByPreset {
  precise: Alignment;
  paper: PaperAlignment;
}

/** The result of `align` for these options. */
export type AlignResult<P extends Core.Preset = Core.Preset, M extends boolean = boolean> = P extends Core.Preset
  ? M extends true
    ? AlignmentByPreset[P]
    : WithoutMetrics<AlignmentByPreset[P]>
  : never;

/** The result of `alignViews`: world from mesh, x_world = s·R·p_mesh + t, in metres, and the pose in each view. */
export interface ViewsAlignment extends Core.ViewsAlignment {
  /** With `transfer: true`: the returned arrays of the input. */
  input?: ViewsInput;
}

/** The result of `Tracker.next`: camera from mesh, x_cam = s·R·p_mesh + t. */
export interface TrackedFrame extends Core.TrackedFrame {
  /** With `transfer: true`: the returned arrays of the frame. */
  input?: FrameInput;
}

/** The result of `evaluate`. */
export interface Evaluation extends Core.Evaluation {
  /** With `transfer: true`: the returned arrays of the input. */
  input?: AlignInput;
}

/** The result of `register` and `estimateSim3`: target from source, y = s·R·x + t. */
export interface Registration extends Core.Registration {
  /** With `transfer: true`: the returned arrays. */
  input?: Clouds;
}

/** Two clouds (interleaved x, y, z) and, for `estimateSim3`, the correspondences between their points. */
export interface Clouds {
  source: Float32Array | Float64Array;
  target: Float32Array | Float64Array;
  correspondences?: Uint32Array;
}

/** One of the results of `alignAll`: an alignment, or the error of its input. */
export type AlignAllResult<A = Alignment> =
  | { index: number; alignment: A; input?: AlignInput; error?: undefined }
  | { index: number; alignment?: undefined; input?: AlignInput; error: Sim3AlignError };

/** The warnings of the readers of files. */
export interface FileWarnings {
  /** Of the camera file. */
  camera: readonly string[];
  /** Of the colours of the mesh file. */
  colors: readonly string[];
}

/** A result whose warnings include those of the input files, before those of the core. */
export function withWarnings<T extends { warnings: Core.Warning[] }>(result: T, { camera, colors }: FileWarnings): T {
  const coded = (code: Core.WarningCode) => (message: string) => ({ code, message });
  const warnings = [...camera.map(coded("CAMERA_NOT_PINHOLE")), ...colors.map(coded("COLORS_NOT_READ"))];
  return { ...result, warnings: [...warnings, ...result.warnings] };
}
