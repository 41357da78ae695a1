/** The splats module: the WebAssembly module that makes meshes of 3D Gaussians. */
import type { MeshArrays } from "./wasm/formats.js";
import { type Glue, type LoadedModule, WasmModule } from "./wasm-module.js";

/** The function of the module. It validates its arguments and throws errors with codes. */
export interface Splats extends Glue {
  readSplats(bytes: Uint8Array, withColors: boolean): MeshArrays;
}

/** Loads the module when 3D Gaussians are first passed. */
export type LoadSplats = () => Promise<LoadedModule<Splats>>;

/** The module, shared by all aligners of this realm. */
export const splatsModule = /* @__PURE__ */ new WasmModule<Splats>(
  "splats",
  () => new URL("./wasm/splats_bg.wasm", import.meta.url),
  async () => (await import("./wasm/splats.js")) as unknown as Splats,
);
