/** The physics module: the WebAssembly module that makes bodies at rest. */
import { WasmModule } from "../modules/module.js";

/** A convex surface. */
export interface ConvexPart {
  /** Interleaved x, y, z, metres, in the frame of the body. */
  positions: Float64Array;
  /** Three vertex indices per triangle, counter-clockwise from outside. */
  indices: Uint32Array;
}

/** World from body, as the module returns it. */
export interface BodyPose {
  rotation: Float64Array;
  translation: Float64Array;
}

/** A body, as the module returns it. */
export interface SettledBody {
  parts: ConvexPart[];
  pose: BodyPose;
  found: BodyPose;
  mass: number;
  center: Float64Array;
  moments: Float64Array;
  axes: Float64Array;
  isFree: boolean;
  movedM: number;
  turnedDeg: number;
  inside: number[];
}

/** The functions of the module. */
export interface Physics {
  settleBodies(objects: readonly object[], settings: object): { bodies: SettledBody[]; supportHeightM: number };
}

/** The module, shared by all scenes of this realm. */
export const physicsModule = /* @__PURE__ */ new WasmModule<Physics>(
  "physics",
  () => new URL("../wasm/physics_bg.wasm", import.meta.url),
  () => import("../wasm/physics.js"),
);
