/** The joint module: the WebAssembly module with `alignScene`, `alignViews` and `track`. */
import type { CoreListener, Task } from "./core.js";
import type { CorrectedFrame, TrackedFrame, ViewsAlignment } from "./generated/types.js";
import type { CoreFrame, CoreInput, CoreViews } from "./input/core-input.js";
import type { CoreMesh } from "./prepared-mesh.js";
import type { Contacts, Known, Placed, Placement, Supported } from "./scene/steps.js";
import { type Glue, type LoadedModule, WasmModule } from "./wasm-module.js";

/** The functions of the module. They validate their arguments and throw errors with codes. */
export interface JointAligner extends Glue {
  beginPlace(
    input: CoreInput & { others?: Uint8Array },
    options: object,
    known: Known | undefined,
    onProgress: CoreListener | undefined,
  ): Task<Placed>;
  sceneSupport(view: object, placements: (Placement | null)[], support: unknown, seed: number): Supported;
  sceneContacts(view: object, placements: (Placement | null)[], supported: Supported, snap: boolean): Contacts;
  beginAlignViews(input: CoreViews, options: object, onProgress: CoreListener | undefined): Task<ViewsAlignment>;
  openTracker(id: number, input: { mesh: CoreMesh }, options: object): void;
  trackFrame(id: number, frame: CoreFrame, onProgress: CoreListener | undefined): TrackedFrame;
  correctTrack(id: number, pose: unknown, frame: unknown): CorrectedFrame[];
  closeTracker(id: number): void;
  dropMesh(id: number): void;
}

/** Loads the module when a call first needs it. */
export type LoadJoint = () => Promise<LoadedModule<JointAligner>>;

/** The module, shared by all aligners of this realm. */
export const jointModule = new WasmModule<JointAligner>(
  "joint",
  () => new URL("./wasm/joint_bg.wasm", import.meta.url),
  async () => (await import("./wasm/joint.js")) as unknown as JointAligner,
);
