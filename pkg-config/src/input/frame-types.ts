/** The inputs of `alignViews` and of trackers. */
import type { Sim3Like } from "../sim3.js";
import type { DepthView, MaskInput, MeshInput } from "./types.js";

/** A frame: what a camera saw, and the mask of the object, if it is known. */
export type FrameInput = DepthView & {
  /** The mask of the object, if it is known. */
  mask?: MaskInput | undefined;
  /** How to resize a mask whose size differs from that of the depth map. By default, such a mask is an error. */
  resizeMask?: "nearest" | undefined;
};

/** One of several views of an object. */
export type ViewInput = FrameInput & {
  /**
   * The pose of the camera: world from camera, of scale 1, in metres (camera: x right, y down, z forward). In all views
   * or in none.
   */
  cameraToWorld?: Sim3Like | undefined;
};

/** The input of `alignViews`. */
export interface ViewsInput {
  /** The mesh to align. */
  mesh: MeshInput;
  /** The views: 1 to 64. At least one has a mask; without `cameraToWorld`, all have. */
  views: readonly ViewInput[];
}
