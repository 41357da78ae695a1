/** Loading and calling one WebAssembly module. */
import { internalError, isCoded, Sim3AlignError } from "./error.js";
import { isKind } from "./values.js";

/** Where a WebAssembly module comes from: an address, a response, the bytes, or the compiled module. */
export type WasmSource = URL | string | Response | BufferSource | WebAssembly.Module;

/** The same, or what gets it once it is needed. */
export type LazySource = WasmSource | (() => WasmSource | Promise<WasmSource>);

/** What wasm-bindgen's glue exports beside the functions themselves. */
export interface Glue {
  default(options: { module_or_path: WebAssembly.Module }): Promise<unknown>;
  __wbg_reset_state(): void;
}

/** A module that loads once, however many ask for it at once; after a failure the next one tries again. */
export class WasmModule<G extends Glue> {
  readonly #name: string;
  readonly #source: LazySource;
  readonly #importGlue: () => Promise<G> | G;
  #compiling: Promise<WebAssembly.Module> | undefined;
  #loading: Promise<LoadedModule<G>> | undefined;

  constructor(name: string, source: LazySource, importGlue: () => Promise<G> | G) {
    this.#name = name;
    this.#source = source;
    this.#importGlue = importGlue;
  }

  /** The compiled module, to be loaded here or elsewhere. `source` counts for the first success only. */
  compile(source: LazySource = this.#source): Promise<WebAssembly.Module> {
    if (this.#compiling === undefined) {
      const compiling = this.#explained(async () => compiled(await given(source)));
      this.#compiling = compiling;
      compiling.catch(() => {
        this.#compiling = undefined;
      });
    }
    return this.#compiling;
  }

  /** The module, ready to be called. `source` counts for the first success only. */
  load(source?: LazySource): Promise<LoadedModule<G>> {
    if (this.#loading === undefined) {
      const loading = this.#instantiate(source);
      this.#loading = loading;
      loading.catch(() => {
        this.#loading = undefined;
      });
    }
    return this.#loading;
  }

  async #instantiate(source: LazySource | undefined): Promise<LoadedModule<G>> {
    const module = await this.compile(source);
    return this.#explained(async () => {
      const glue = await this.#importGlue();
      await glue.default({ module_or_path: module });
      return new LoadedModule(glue);
    });
  }

  async #explained<T>(work: () => Promise<T>): Promise<T> {
    try {
      return await work();
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

/** Thrown through a module by what it calls back: ends the call, whose caller gets the reason. */
export class Stopped {
  readonly reason: unknown;

  constructor(reason: unknown) {
    this.reason = reason;
  }
}

/** A loaded module. */
export class LoadedModule<G extends Glue> {
  readonly #glue: G;
  #isSpent = false;

  constructor(glue: G) {
    this.#glue = glue;
  }

  /**
   * Calls the module. What it says about its input becomes a {@link Sim3AlignError}, whose argument `rename` may
   * change to what the caller knows it as; after anything else the module's state is unknown, and the next call gets
   * a new instance.
   */
  call<T>(work: (glue: G) => T, rename: (argument: string) => string = (argument) => argument): T {
    if (this.#isSpent) {
      this.#glue.__wbg_reset_state();
      this.#isSpent = false;
    }
    try {
      return work(this.#glue);
    } catch (error) {
      if (isCoded(error)) {
        const { code, argument, found, expected, remedy } = error;
        throw new Sim3AlignError({ code, argument: rename(argument), found, expected, remedy });
      }
      this.#isSpent = true;
      throw error instanceof Stopped ? error.reason : internalError(error);
    }
  }
}

const given = (source: LazySource) => (typeof source === "function" ? source() : source);

async function compiled(source: WasmSource): Promise<WebAssembly.Module> {
  if (isKind<WebAssembly.Module>(source, "WebAssembly.Module")) return source;
  const isAddress = typeof source === "string" || isKind<URL>(source, "URL");
  const code = isAddress ? await fetched(String(source)) : source;
  if (!isKind<Response>(code, "Response")) return WebAssembly.compile(code as BufferSource);
  if (!code.ok) throw new Error(`${code.status} ${code.statusText} at ${code.url}`);
  // Servers that don't know the type are no reason to fail, and none for a warning on the console.
  const isTyped = code.headers.get("content-type")?.startsWith("application/wasm");
  return isTyped ? WebAssembly.compileStreaming(code) : WebAssembly.compile(await code.arrayBuffer());
}

/** What is at an address; Node fetches no files. */
async function fetched(address: string): Promise<Response | BufferSource> {
  if (!address.startsWith("file:")) return fetch(address);
  // A name that bundlers for browsers don't follow: they never come here.
  const fileSystem = "node:fs/promises";
  const { readFile } = (await import(
    /* webpackIgnore: true */ /* @vite-ignore */ fileSystem
  )) as typeof import("node:fs/promises");
  return readFile(new URL(address));
}
