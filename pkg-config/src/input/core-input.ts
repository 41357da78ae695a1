/** The input of the core. */
import type { Pinhole } from "../formats/pinhole.js";
import type { CoreMesh } from "../prepared-mesh.js";
import type { Photo } from "./colors.js";

/** The input of the core, which checks lengths and values. */
export interface CoreInput {
  depth?: Float32Array | Uint16Array;
  depthScale?: unknown;
  pointMap?: Float32Array;
  width?: unknown;
  height?: unknown;
  mask: Uint8Array | Uint8ClampedArray;
  maskWidth?: number;
  maskHeight?: number;
  resizeMask?: unknown;
  camera?: Pinhole;
  image?: Photo;
  mesh: CoreMesh;
}

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
