/** The file readers' WebAssembly module. */
import type { Formats } from "./core.js";
import { WasmModule } from "./wasm-module.js";

/** The file readers, shared by all of this realm. */
export const formatsModule = new WasmModule<Formats>(
  "formats",
  () => new URL("./wasm/formats_bg.wasm", import.meta.url),
  () => import("./wasm/formats.js"),
);
