/** The formats module: the WebAssembly module that reads mesh files, images and NPY. */
import { type LoadedModule, WasmModule } from "./wasm-module.js";

/** The functions of the file readers. */
export type Formats = typeof import("./wasm/formats.js");

/** Loads the file readers when the first file is passed. */
export type LoadFormats = () => Promise<LoadedModule<Formats>>;

/** The file readers, shared by all aligners of this realm. */
export const formatsModule = /* @__PURE__ */ new WasmModule<Formats>(
  "formats",
  () => new URL("./wasm/formats_bg.wasm", import.meta.url),
  () => import("./wasm/formats.js"),
);
