/** Loading and calling the two WebAssembly modules: the core, and the file readers that most callers never need. */
import { internalError, isCoded, Sim3AlignError } from "./error.js";
import type * as Results from "./generated/types.js";
import type { CoreInput } from "./input/resolve.js";
import type { Defaults } from "./options.js";
import * as core from "./wasm/core.js";

/** Where a WebAssembly module comes from: an address, a response, the bytes, or the compiled module. */
export type WasmSource = URL | string | Response | BufferSource | WebAssembly.Module;

/** What wasm-bindgen's glue exports beside the functions themselves. */
interface Glue {
  default(options: { module_or_path: WasmSource }): Promise<unknown>;
  __wbg_reset_state(): void;
}

/** Points, x, y, z one after the other. */
type Cloud = Float32Array | Float64Array;

/** The core's functions: they check what they are given, and throw coded errors. */
export interface Core extends Glue {
  align(
    input: CoreInput,
    options: object,
    onProgress: ((stage: Results.Stage, fraction: number) => void) | undefined,
  ): Results.Alignment;
  evaluate(input: CoreInput, transform: unknown, options: object): Results.Evaluation;
  register(source: Cloud, target: Cloud, options: object): Results.Registration;
  estimateSim3(source: Cloud, target: Cloud, correspondences: Uint32Array, options: object): Results.Registration;
  defaults(): Defaults;
  version(): string;
}

/** The file readers' functions. */
export type Formats = typeof import("./wasm/formats.js");

/** A module that loads once, however many ask for it at once; after a failure the next one tries again. */
export class WasmModule<G extends Glue> {
  readonly #name: string;
  readonly #url: URL;
  readonly #importGlue: () => Promise<G>;
  #loading: Promise<LoadedModule<G>> | undefined;

  constructor(name: string, url: URL, importGlue: () => Promise<G>) {
    this.#name = name;
    this.#url = url;
    this.#importGlue = importGlue;
  }

  /** The module, ready to be called. `source` counts for the first successful load only. */
  load(source: WasmSource = this.#url): Promise<LoadedModule<G>> {
    if (this.#loading === undefined) {
      const loading = this.#instantiate(source);
      this.#loading = loading;
      loading.catch(() => {
        this.#loading = undefined;
      });
    }
    return this.#loading;
  }

  async #instantiate(source: WasmSource): Promise<LoadedModule<G>> {
    try {
      const glue = await this.#importGlue();
      await glue.default({ module_or_path: await readable(source) });
      return new LoadedModule(glue);
    } catch (cause) {
      throw new Sim3AlignError(
        {
          code: "NOT_INITIALISED",
          argument: this.#name === "core" ? "wasm" : "formatsWasm",
          found: cause instanceof Error ? cause.message : String(cause),
          expected: `the WebAssembly module ${this.#name}_bg.wasm of this very version`,
          remedy: `Serve sim3align/wasm/${this.#name}_bg.wasm beside the script, or pass createAligner its address, bytes or module.`,
        },
        { cause },
      );
    }
  }
}

/** A loaded module. */
export class LoadedModule<G extends Glue> {
  readonly #glue: G;
  #trapped = false;

  constructor(glue: G) {
    this.#glue = glue;
  }

  /**
   * Calls the module. What it says about its input becomes a {@link Sim3AlignError}, whose argument `rename` may
   * change to what the caller knows it as; after anything else the module's state is unknown, and the next call gets
   * a new instance.
   */
  call<T>(work: (glue: G) => T, rename: (argument: string) => string = (argument) => argument): T {
    if (this.#trapped) {
      this.#glue.__wbg_reset_state();
      this.#trapped = false;
    }
    try {
      return work(this.#glue);
    } catch (error) {
      if (isCoded(error)) {
        const { code, argument, found, expected, remedy } = error;
        throw new Sim3AlignError({ code, argument: rename(argument), found, expected, remedy });
      }
      this.#trapped = true;
      throw internalError(error);
    }
  }
}

/** What the glue can load: it fetches addresses, which Node can't do for files. */
async function readable(source: WasmSource): Promise<WasmSource> {
  if (!(source instanceof URL) && typeof source !== "string") return source;
  const address = String(source);
  if (!address.startsWith("file:")) return source;
  // A name that bundlers for browsers don't follow: they never come here.
  const fileSystem = "node:fs/promises";
  const { readFile } = (await import(
    /* webpackIgnore: true */ /* @vite-ignore */ fileSystem
  )) as typeof import("node:fs/promises");
  return readFile(new URL(address));
}

/** The core, shared by all aligners of this realm. */
export const coreModule = new WasmModule<Core>(
  "core",
  new URL("./wasm/core_bg.wasm", import.meta.url),
  async () => core as unknown as Core,
);

/** The file readers. */
export const formatsModule = new WasmModule<Formats>(
  "formats",
  new URL("./wasm/formats_bg.wasm", import.meta.url),
  () => import("./wasm/formats.js"),
);
