/** The WebAssembly modules of the aligner, shared by all aligners of this realm, and where the caller has them. */

import type { LazySource, WasmSource } from "../types/platform.js";
import { invalidArgument } from "../values/error.js";
import { isKind, isRecord } from "../values/kinds.js";
import * as coreGlue from "../wasm/core.js";
import type { Core, Joint, ModuleName, Registrar } from "./exports.js";
import { type ModuleTable, moduleFile, WasmModule } from "./module.js";
import { readerModules } from "./readers.js";

export const coreModule = /* @__PURE__ */ new WasmModule<Core>(
  "core",
  () => new URL("../wasm/core_bg.wasm", import.meta.url),
  () => coreGlue,
);

const jointModule = /* @__PURE__ */ new WasmModule<Joint>(
  "joint",
  () => new URL("../wasm/joint_bg.wasm", import.meta.url),
  () => import("../wasm/joint.js"),
);

export const registrationModule = /* @__PURE__ */ new WasmModule<Registrar>(
  "registration",
  () => new URL("../wasm/registration_bg.wasm", import.meta.url),
  () => import("../wasm/registration.js"),
);

/** All modules. */
export const wasmModules: ModuleTable = {
  core: coreModule,
  ...readerModules,
  joint: jointModule,
  registration: registrationModule,
};

/** The sources of the modules, each loaded when it is first needed. Those left out are next to the script. */
export interface WasmModules {
  /** The core module, which `createAligner` loads: `core_bg.wasm`. */
  core?: WasmSource | undefined;
  /** The formats module, for files of meshes, images and arrays: `formats_bg.wasm`. */
  formats?: WasmSource | undefined;
  /** The depth-files module, for depth as NPZ, EXR, TIFF or PFM: `depth-files_bg.wasm`. */
  depthFiles?: WasmSource | undefined;
  /** The splats module, for meshes as 3D Gaussians: `splats_bg.wasm`. */
  splats?: WasmSource | undefined;
  /** The WebP module, for photos and textures in that format: `webp_bg.wasm`. */
  webp?: WasmSource | undefined;
  /** The joint module, for `alignScene`, `alignViews` and `track`: `joint_bg.wasm`. */
  joint?: WasmSource | undefined;
  /** The registration module, for `register`, `estimateSim3` and `preset: "paper"`: `registration_bg.wasm`. */
  registration?: WasmSource | undefined;
}

/** The source of each module, or a function that returns it on demand. */
export type LazyModules = { readonly [N in ModuleName]?: LazySource | undefined };

/** The option `wasm` of `createAligner`, as one source for each module. */
export function checkedModules(wasm: unknown): LazyModules {
  const names = Object.keys(wasmModules);
  if (wasm === undefined) return {};
  if (typeof wasm === "string" || isKind<URL>(wasm, "URL")) {
    const folder = String(wasm).replace(/\/?$/, "/");
    return Object.fromEntries(names.map((name) => [name, `${folder}${moduleFile(name)}`]));
  }
  if (isRecord(wasm) && Object.keys(wasm).every((name) => names.includes(name))) return wasm;
  const expected = `the URL of the folder of the modules, or the sources of ${names.join(", ")}`;
  throw invalidArgument("wasm", wasm, expected, "Pass { core: source } for the source of the core module alone.");
}
