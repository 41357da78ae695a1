/** The modules that read files, each loaded when a file first needs it. */
import type { DepthFiles, Formats, Splats, Webp } from "./exports.js";
import { type Modules, WasmModule } from "./module.js";

export const formatsModule = /* @__PURE__ */ new WasmModule<Formats>(
  "formats",
  () => new URL("../wasm/formats_bg.wasm", import.meta.url),
  () => import("../wasm/formats.js"),
);

const depthFilesModule = /* @__PURE__ */ new WasmModule<DepthFiles>(
  "depthFiles",
  () => new URL("../wasm/depth-files_bg.wasm", import.meta.url),
  () => import("../wasm/depth-files.js"),
);

const splatsModule = /* @__PURE__ */ new WasmModule<Splats>(
  "splats",
  () => new URL("../wasm/splats_bg.wasm", import.meta.url),
  () => import("../wasm/splats.js"),
);

const webpModule = /* @__PURE__ */ new WasmModule<Webp>(
  "webp",
  () => new URL("../wasm/webp_bg.wasm", import.meta.url),
  () => import("../wasm/webp.js"),
);

/** The modules of the readers, shared by all aligners of this realm. */
export const readerModules = {
  formats: formatsModule,
  depthFiles: depthFilesModule,
  splats: splatsModule,
  webp: webpModule,
};

/** Loads each module when a file first needs it. */
export type FileReaders = Pick<Modules, "formats" | "depthFiles" | "splats" | "webp">;

/** Loads the readers of mesh files, images and NPY. */
export type LoadFormats = Modules["formats"];

/** The readers that are shared by all aligners of this realm. */
export const fileReaders: FileReaders = {
  formats: () => formatsModule.load(),
  depthFiles: () => depthFilesModule.load(),
  splats: () => splatsModule.load(),
  webp: () => webpModule.load(),
};
