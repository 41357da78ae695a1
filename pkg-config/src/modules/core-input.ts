/** The input of the core. */
import type { Pinhole } from "../camera/pinhole.js";
import type { DepthKind } from "../types/inputs.js";
import type { PixelArray } from "../values/pixels.js";
import type { CoreMesh } from "../values/prepared-mesh.js";

/** Pixels of a photo: sRGB-encoded red, green and blue, row-major. */
export type Photo = PixelArray<Uint8Array>;

/** The input of the core, which checks lengths and values. */
export interface CoreInput {
  depth?: Float32Array | Uint16Array;
  depthScale?: unknown;
  /** The kind of the depth values, unless they are metric. */
  depthKind?: DepthKind;
  pointMap?: Float32Array;
  width?: unknown;
  height?: unknown;
  mask: Uint8Array | Uint8ClampedArray;
  maskWidth?: number;
  maskHeight?: number;
  resizeMask?: unknown;
  camera?: Pinhole;
  /** Standard deviation of the logarithm of the focal length, if it is a guess. */
  focalDeviation?: number;
  image?: Photo;
  mesh: CoreMesh;
}

/** The depth, the photo and the camera of an input. */
export type CoreView = Omit<CoreInput, "mask" | "maskWidth" | "maskHeight" | "resizeMask" | "mesh">;

/** A frame for the core. */
export type CoreFrame = Omit<CoreInput, "mask" | "mesh"> & {
  mask?: CoreInput["mask"];
  cameraToWorld?: unknown;
};

/** Several views for the core. */
export interface CoreViews {
  mesh: CoreMesh;
  views: CoreFrame[];
}
