/** The registration module: the WebAssembly module with `register`, `estimateSim3`, the preset `paper` and errors of BOP. */
import type { Cloud, CoreListener, Task } from "./core.js";
import type { BopErrors, PaperAlignment, Registration } from "./generated/types.js";
import type { CoreInput } from "./input/core-input.js";
import { type Glue, type LoadedModule, WasmModule } from "./wasm-module.js";

/** The functions of the module. They validate their arguments and throw errors with codes. */
export interface Registrar extends Glue {
  alignPaper(input: CoreInput, options: object, onProgress: CoreListener | undefined): PaperAlignment;
  bopErrors(input: object, estimates: readonly object[], truths: readonly object[]): BopErrors[];
  beginRegister(source: Cloud, target: Cloud, options: object): Task<Registration>;
  beginEstimateSim3(source: Cloud, target: Cloud, correspondences: Uint32Array, options: object): Task<Registration>;
}

/** Loads the module when a call first needs it. */
export type LoadRegistrar = () => Promise<LoadedModule<Registrar>>;

/** The module, shared by all aligners of this realm. */
export const registrationModule = /* @__PURE__ */ new WasmModule<Registrar>(
  "registration",
  () => new URL("./wasm/registration_bg.wasm", import.meta.url),
  async () => (await import("./wasm/registration.js")) as unknown as Registrar,
);
