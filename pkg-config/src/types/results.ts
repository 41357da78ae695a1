/**
 * Results of the calls: plain objects, which `JSON.stringify` writes completely. `null` marks a value that could not be
 * measured.
 */

import type * as Core from "../generated/types.js";
import type { Sim3AlignError } from "../values/error.js";
import type { AlignInput, DepthImage, FrameInput, ViewsInput } from "./inputs.js";

/** How the depth map and the camera of a view were read. */
export interface InputInfo {
  /** The unit of the depth. */
  depthUnit?: DepthImage["unit"];
  /** Where the intrinsics come from, if they were not given: `"depth file"`, `"EXIF: …"`, or `"estimate"`. */
  cameraSource?: string;
  /** Which values of the mask file are the object: `"values of 127.5 or more, of 0 to 255"`. */
  maskReading?: string;
  /** How the photo was turned, if not as its EXIF data say: `"as stored, in the shape of the depth map"`. */
  imageReading?: string;
  /**
   * What the depth and the lens were taken to be, if they were not fully known. All lengths of the result are metres if
   * `isMetric`; otherwise, their unit is unknown, and `correctDepth` of `sim3align/conventions` returns the depth map in it.
   */
  depthCalibration?: Core.DepthCalibration;
}

/** The result of `align`: camera from mesh, x_cam = s·R·p_mesh + t (OpenCV: x right, y down, z forward; metres). */
export interface Alignment extends Core.Alignment, InputInfo {
  /** With `transfer: true`: the returned arrays of the input. */
  input?: AlignInput;
}

/** The result of `align` with `preset: "paper"`. */
export interface PaperAlignment extends Core.PaperAlignment, InputInfo {
  /** With `transfer: true`: the returned arrays of the input. */
  input?: AlignInput;
}

/** The result of `align` for a preset, with or without `metrics`. */
export type AlignResult<P extends Core.Preset = Core.Preset, M extends boolean = boolean> = P extends Core.Preset
  ? M extends true
    ? { precise: Alignment; paper: PaperAlignment }[P]
    : Omit<{ precise: Alignment; paper: PaperAlignment }[P], "metrics"> & { metrics?: undefined }
  : never;

/** The object in one of several views. */
export interface ViewAlignment extends Core.ViewPose, InputInfo {}

/** The result of `alignViews`: world from mesh, x_world = s·R·p_mesh + t, in metres, and the pose in each view. */
export interface ViewsAlignment extends Core.ViewsAlignment {
  /** In the order of the input. */
  views: ViewAlignment[];
  /** With `transfer: true`: the returned arrays of the input. */
  input?: ViewsInput;
}

/** The result of `Tracker.next`: camera from mesh, x_cam = s·R·p_mesh + t. */
export interface TrackedFrame extends Core.TrackedFrame, InputInfo {
  /** With `transfer: true`: the returned arrays of the frame. */
  input?: FrameInput;
}

/** The result of `evaluate`. */
export interface Evaluation extends Core.Evaluation, Omit<InputInfo, "depthCalibration"> {
  /** With `transfer: true`: the returned arrays of the input. */
  input?: AlignInput;
}

/** The result of `register` and `estimateSim3`: target from source, y = s·R·x + t. */
export interface Registration extends Core.Registration {
  /** With `transfer: true`: the returned arrays. */
  input?: {
    source: Float32Array | Float64Array;
    target: Float32Array | Float64Array;
    correspondences?: Uint32Array;
  };
}

/** One of the results of `alignAll`: an alignment, or the error of its input. */
export type AlignAllResult<A = Alignment> =
  | { index: number; alignment: A; input?: AlignInput; error?: undefined }
  | { index: number; alignment?: undefined; input?: AlignInput; error: Sim3AlignError };

/** Notes on the files of an input, for its result. */
export interface InputNotes extends Omit<InputInfo, "depthCalibration"> {
  /** What was subtracted from the coordinates of the mesh file. */
  origin?: readonly number[];
  /** Conditions that concern the view. */
  warnings: readonly Core.Warning[];
  /** Conditions that matter if the pose is in doubt. */
  doubts?: readonly Core.Warning[];
  /** What the files hold besides, and their readers do not know. */
  unread: readonly string[];
  /** Reasons why the colours of the mesh file are not read. */
  colors: readonly string[];
}
