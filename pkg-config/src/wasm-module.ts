/** Loading and calling one WebAssembly module. */
import { internalError, isCoded, Sim3AlignError } from "./error.js";
import type { LazySource, WasmSource } from "./platform.js";
import { isKind } from "./values.js";

/** The exports of wasm-bindgen's glue, other than the functions of the module. */
export interface Glue {
  default(options: { module_or_path: WebAssembly.Module }): Promise<unknown>;
  __wbg_reset_state(): void;
}

/** A module that is loaded once, also for concurrent callers. After a failure, the next call tries again. */
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

  /** Compiles the module, for this thread or a worker. Only the `source` of the first successful call is used. */
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

  /** Loads the module. Only the `source` of the first successful call is used. */
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
  // If a server bundler has moved this script, the file is not next to it, or the script has no URL.
  const isMoved = cause instanceof Error && "code" in cause && ["ENOENT", "ERR_INVALID_URL"].includes(`${cause.code}`);
  const remedy = isMoved
    ? `If a bundler has moved this script, import from "sim3align/inline", which needs no other file, or exclude sim3align from the bundle; or pass createAligner the URL, bytes or module of ${file}.`
    : `Serve sim3align/wasm/${file} next to the script, or pass createAligner its URL, bytes or module.`;
  return new Sim3AlignError(
    {
      code: "NOT_INITIALISED",
      argument: name === "core" ? "wasm" : `${name}Wasm`,
      found: cause instanceof Error ? cause.message : String(cause),
      expected: `the WebAssembly module ${file} of the same version`,
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

  /** The number of the current instance; objects of earlier instances are lost. */
  get instance(): number {
    return this.#isSpent ? this.#instance + 1 : this.#instance;
  }

  /**
   * Calls the module. Its errors about the input become {@link Sim3AlignError}s; `rename` maps their argument names to
   * those of the caller. After any other exception, the state of the module is unknown, and the next call uses a new
   * instance.
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
  // With a wrong MIME type, streaming would fail, and the fallback would log a console warning.
  const isTyped = code.headers.get("content-type")?.startsWith("application/wasm");
  return isTyped ? WebAssembly.compileStreaming(code) : WebAssembly.compile(await code.arrayBuffer());
}

/** The content of a URL. Reads `file:` URLs separately, because `fetch` of Node does not support them. */
async function fetched(address: string): Promise<Response | BufferSource> {
  if (!address.startsWith("file:")) return fetch(address);
  // The name is in a variable, so that browser bundlers do not resolve it.
  const fileSystem = "node:fs/promises";
  const { readFile } = (await import(
    /* webpackIgnore: true */ /* @vite-ignore */ fileSystem
  )) as typeof import("node:fs/promises");
  return readFile(new URL(address));
}
