/** The joint module: the WebAssembly module with `alignScene`, `alignViews` and `track`. */
import type { Calibrated, CalibrationObject } from "./calibrate.js";
import type { CoreHelpers, CoreListener, Helper, Task } from "./core.js";
import type {
  Alignment,
  Contact,
  CorrectedFrame,
  DepthCalibration,
  Sim3,
  TrackedFrame,
  ViewsAlignment,
} from "./generated/types.js";
import type { CoreFrame, CoreInput, CoreView, CoreViews } from "./input/core-input.js";
import type { CoreMesh } from "./prepared-mesh.js";
import type { Support } from "./scene/types.js";
import { type Glue, type LoadedModule, WasmModule } from "./wasm-module.js";

/** An object of a scene, aligned in one of its rounds. */
export interface Placed {
  /** What it tells the next round; only the module reads it. */
  placement: Uint8Array;
  /** In the last round. */
  alignment?: Alignment;
}

/** The poses of the objects of a scene, `null` for one that could not be aligned, and what they stand on. */
export interface Arrangement {
  plan?: undefined;
  objects: ((Pick<Sim3, "translation" | "matrix"> & { contact: Contact }) | null)[];
  support: Support | null;
}

/** The functions of the module. They validate their arguments and throw errors with codes. */
export interface JointAligner extends Glue {
  beginPlace(
    input: CoreInput & { others: Uint8Array | undefined },
    options: object,
    plan: Uint8Array | undefined,
    object: number,
    onProgress: CoreListener | undefined,
    helpers: CoreHelpers | undefined,
  ): Task<Placed>;
  beginHelpPlace(
    input: CoreInput & { others: Uint8Array | undefined },
    options: object,
    plan: Uint8Array | undefined,
    object: number,
  ): Helper;
  planScene(
    scene: object,
    plan: Uint8Array | undefined,
    placements: (Uint8Array | null)[],
  ): { plan: Uint8Array } | Arrangement;
  beginCalibrate(
    input: CoreView & { objects: CalibrationObject[] },
    onProgress: CoreListener | undefined,
  ): Task<Calibrated>;
  beginCalibrateViews(input: CoreViews & { options: object }, onProgress: CoreListener | undefined): Task<Calibrated[]>;
  beginAlignViews(
    input: CoreViews,
    options: object,
    onProgress: CoreListener | undefined,
    helpers: CoreHelpers | undefined,
  ): Task<ViewsAlignment>;
  beginHelpViews(input: CoreViews, options: object): Helper;
  openTracker(id: number, input: { mesh: CoreMesh }, options: object): void;
  trackFrame(
    id: number,
    frame: CoreFrame,
    onProgress: CoreListener | undefined,
  ): TrackedFrame & { depthCalibration?: DepthCalibration };
  correctTrack(id: number, pose: unknown, frame: unknown): CorrectedFrame[];
  closeTracker(id: number): void;
  dropMesh(id: number): void;
}

/** Loads the module when a call first needs it. */
export type LoadJoint = () => Promise<LoadedModule<JointAligner>>;

/** The module, shared by all aligners of this realm. */
export const jointModule = /* @__PURE__ */ new WasmModule<JointAligner>(
  "joint",
  () => new URL("./wasm/joint_bg.wasm", import.meta.url),
  async () => (await import("./wasm/joint.js")) as unknown as JointAligner,
);
