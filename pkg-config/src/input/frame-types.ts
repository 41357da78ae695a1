/** The inputs of `alignViews` and of trackers. */
import type { Sim3Like } from "../sim3.js";
import type { AlignInput, MaskInput, MeshInput } from "./types.js";

/** The properties of an input that describe its depth map and camera. */
type WithoutObject<T> = T extends unknown ? Omit<T, "mask" | "mesh"> : never;

/** A frame: depth with a camera, or a point map; and the photo and the mask of the object, if they are known. */
export type FrameInput = WithoutObject<AlignInput> & {
  /** The mask of the object, if it is known. */
  mask?: MaskInput | undefined;
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
