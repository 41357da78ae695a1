/** The depth-files module: the WebAssembly module that reads depth maps as depth models write them (NPZ, EXR, TIFF, PFM). */
import type { DepthImage } from "./input/depth-reading.js";
import { type Glue, type LoadedModule, WasmModule } from "./wasm-module.js";

/** The functions of the module. They validate their arguments and throw errors with codes. */
export interface DepthFiles extends Glue {
  readDepthFile(bytes: Uint8Array, options: object): DepthImage;
}

/** Loads the module when such a file is first passed. */
export type LoadDepthFiles = () => Promise<LoadedModule<DepthFiles>>;

/** The module, shared by all aligners of this realm. */
export const depthFilesModule = /* @__PURE__ */ new WasmModule<DepthFiles>(
  "depthFiles",
  () => new URL("./wasm/depth-files_bg.wasm", import.meta.url),
  async () => (await import("./wasm/depth-files.js")) as unknown as DepthFiles,
);
