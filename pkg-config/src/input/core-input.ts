/** The input as the core takes it. */
import type { Pinhole } from "../formats/pinhole.js";

/** An input as the core takes it; the core checks lengths and values. */
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
  mesh: CoreMesh;
}

/** A mesh as the core takes it. */
export interface CoreMesh {
  positions: Float32Array;
  indices?: Uint32Array | Uint16Array;
  /** The number under which the core keeps the mesh. Where it does already, the arrays are not read. */
  id?: number;
}
