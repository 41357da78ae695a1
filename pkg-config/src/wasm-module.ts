/** Loading and calling one WebAssembly module. */
import { internalError, isCoded, Sim3AlignError } from "./error.js";
import type { LazySource, WasmSource } from "./platform.js";
import { isKind } from "./values.js";

/** The exports of wasm-bindgen's glue beside the module's own functions. */
export interface Glue {
  default(options: { module_or_path: WebAssembly.Module }): Promise<unknown>;
  __wbg_reset_state(): void;
}

/** A module that is loaded once, however many callers ask at the same time. After a failure the next call tries again. */
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

  /** Compiles the module, to be loaded here or in a worker. Only the first successful call's `source` counts. */
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

  /** Loads the module. Only the first successful call's `source` counts. */
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
      throw notLoaded(this.#name, cause);
    }
  }
}

function notLoaded(name: string, cause: unknown): Sim3AlignError {
  const file = `${name}_bg.wasm`;
  // A script that a bundler for servers has moved has no such file beside it, or no address of its own.
  const isMoved = cause instanceof Error && "code" in cause && ["ENOENT", "ERR_INVALID_URL"].includes(`${cause.code}`);
  const remedy = isMoved
    ? `If a bundler has put this script elsewhere, import from "sim3align/inline", which needs no other file, or leave sim3align out of the bundle; or pass createAligner the address, bytes or module of ${file}.`
    : `Serve sim3align/wasm/${file} beside the script, or pass createAligner its address, bytes or module.`;
  return new Sim3AlignError(
    {
      code: "NOT_INITIALISED",
      argument: name === "core" ? "wasm" : "formatsWasm",
      found: cause instanceof Error ? cause.message : String(cause),
      expected: `the WebAssembly module ${file} of this very version`,
      remedy,
    },
    { cause },
  );
}

/** A loaded module. */
export class LoadedModule<G extends Glue> {
  readonly #glue: G;
  #isSpent = false;
  #instance = 0;

  constructor(glue: G) {
    this.#glue = glue;
  }

  /** Which instance calls go to: objects of another one are gone. */
  get instance(): number {
    return this.#isSpent ? this.#instance + 1 : this.#instance;
  }

  /**
   * Calls the module. Its errors about the input become {@link Sim3AlignError}s; `rename` turns the names of their
   * arguments into those that the caller knows. After any other exception the state of the module is unknown, and the
   * next call gets a new instance.
   */
  call<T>(work: (glue: G) => T, rename: (argument: string) => string = (argument) => argument): T {
    if (this.#isSpent) {
      this.#glue.__wbg_reset_state();
      this.#isSpent = false;
      this.#instance += 1;
    }
    try {
      return work(this.#glue);
    } catch (error) {
      if (isCoded(error)) {
        const { code, argument, found, expected, remedy } = error;
        throw new Sim3AlignError({ code, argument: rename(argument), found, expected, remedy });
      }
      this.#isSpent = true;
      throw internalError(error);
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
  // Without the type, streaming would fail, and a fallback would print a warning on the console.
  const isTyped = code.headers.get("content-type")?.startsWith("application/wasm");
  return isTyped ? WebAssembly.compileStreaming(code) : WebAssembly.compile(await code.arrayBuffer());
}

/** The content at an address; Node's `fetch` reads no files. */
async function fetched(address: string): Promise<Response | BufferSource> {
  if (!address.startsWith("file:")) return fetch(address);
  // Bundlers for browsers do not follow a name in a variable; browsers never get here.
  const fileSystem = "node:fs/promises";
  const { readFile } = (await import(
    /* webpackIgnore: true */ /* @vite-ignore */ fileSystem
  )) as typeof import("node:fs/promises");
  return readFile(new URL(address));
}
