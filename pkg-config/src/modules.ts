/** The two WebAssembly modules: the core, and the file readers that most callers never need. */
import type { Core } from "./core.js";
import * as core from "./wasm/core.js";
import { WasmModule } from "./wasm-module.js";

export { formatsModule } from "./formats-module.js";

/** The core, shared by all aligners of this realm. */
export const coreModule = new WasmModule<Core>(
  "core",
  () => new URL("./wasm/core_bg.wasm", import.meta.url),
  () => core as unknown as Core,
);
