/** Loading and calling one WebAssembly module. */

import { Queue } from "../concurrency/queue.js";
import type { LazySource, WasmSource } from "../types/platform.js";
import { checkAttached } from "../values/border.js";
import {
  failure,
  internalError,
  isCoded,
  isExhausted,
  outOfMemory,
  Sim3AlignError,
  withoutInput,
} from "../values/error.js";
import { isKind } from "../values/kinds.js";
import type { Exports, ModuleName } from "./exports.js";

/** A compiled `WebAssembly.Module`, whose type no library but the DOM's declares. */
export type CompiledModule = object;

/** Loads each module when it is first needed. */
export type Modules = { readonly [N in ModuleName]: () => Promise<LoadedModule<Exports[N]>> };

/** A module by each name. */
export type ModuleTable = { readonly [N in ModuleName]: WasmModule<Exports[N]> };

/** The modules as functions that load them. */
export const modulesBy = (load: <N extends ModuleName>(name: N) => Promise<LoadedModule<Exports[N]>>): Modules => ({
  core: () => load("core"),
  formats: () => load("formats"),
  depthFiles: () => load("depthFiles"),
  splats: () => load("splats"),
  webp: () => load("webp"),
  joint: () => load("joint"),
  registration: () => load("registration"),
});

/** The file of a module. */
export const moduleFile = (name: string): string =>
  `${name.replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`)}_bg.wasm`;

/** The exports of wasm-bindgen's glue, other than the functions of the module. */
interface Glue {
  default(options: { module_or_path: CompiledModule }): Promise<unknown>;
  /** The exports of the current instance, once there is one. */
  initSync(options: { module: CompiledModule }): { memory: { buffer: ArrayBufferLike } };
  __wbg_reset_state(): void;
}

/**
 * The largest heap that an instance keeps when no call runs or waits, bytes: more than an alignment of 4096×3072 pixels needs.
 * The heap of WebAssembly never shrinks, so that a larger one is let go with its instance.
 */
const MAX_IDLE_HEAP = 192 * 2 ** 20;

/**
 * The heaps of the modules of this thread. The jobs that run here use them one after the other, as in a worker: otherwise,
 * each that has begun would hold its memory until all have ended.
 */
export const heaps = /* @__PURE__ */ new Queue(["heaps"]);

const loaded = new Set<{ letGo(): void }>();

/** Gives the heaps to the next job, or lets go of those that have grown too large. */
export function releaseHeaps(held: string): void {
  heaps.release(held);
  if (!heaps.isBusy) for (const module of loaded) module.letGo();
}

/** A module that is loaded once, also for concurrent callers. After a failure, the next call tries again. */
export class WasmModule<G> {
  readonly #name: string;
  readonly #source: LazySource;
  readonly #importGlue: () => unknown;
  #compiling: Promise<CompiledModule> | undefined;
  #loading: Promise<LoadedModule<G>> | undefined;
  #loaded: LoadedModule<G> | undefined;

  /** @param importGlue returns the glue of wasm-bindgen, whose declarations lack the functions of most modules */
  constructor(name: string, source: LazySource, importGlue: () => unknown) {
    this.#name = name;
    this.#source = source;
    this.#importGlue = importGlue;
  }

  /** Compiles the module, for this thread or a worker. Only the `source` of the first successful call is used. */
  compile(source: LazySource = this.#source): Promise<CompiledModule> {
    if (this.#compiling === undefined) {
      const compiling = this.#explained(async () => compiled(await given(source)));
      this.#compiling = compiling;
      compiling.catch(() => {
        this.#compiling = undefined;
      });
    }
    return this.#compiling;
  }

  /** The module, if it has been loaded. */
  get loaded(): LoadedModule<G> | undefined {
    return this.#loaded;
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
      const glue = (await this.#importGlue()) as G & Glue;
      await glue.default({ module_or_path: module });
      this.#loaded = new LoadedModule<G>(glue, module);
      return this.#loaded;
    });
  }

  async #explained<T>(work: () => Promise<T>): Promise<T> {
    try {
      return await work();
    } catch (cause) {
      // A worker gets the reason why its module could not be loaded.
      throw cause instanceof Sim3AlignError ? cause : notLoaded(this.#name, cause);
    }
  }
}

function notLoaded(name: string, cause: unknown): Sim3AlignError {
  if (isExhausted(cause)) return outOfMemory(cause);
  const file = moduleFile(name);
  // If a server bundler has moved this script, the file is not next to it, or the script has no URL.
  const isMoved = cause instanceof Error && "code" in cause && ["ENOENT", "ERR_INVALID_URL"].includes(`${cause.code}`);
  const remedy = isMoved
    ? `If a bundler has moved this script, import from "sim3align/inline", which needs no other file, or exclude sim3align from the bundle; or pass createAligner the URL, bytes or module of ${file}.`
    : `Serve sim3align/wasm/${file} next to the script, or pass createAligner its URL, bytes or module; with esbuild, import from "sim3align/inline"; with Vite before 8, set optimizeDeps.exclude.`;
  const found = cause instanceof Error ? cause.message : String(cause);
  const expected = `the WebAssembly module ${file} of the same version`;
  return failure("NOT_INITIALISED", `wasm.${name}`, found, expected, remedy, cause);
}

/** A loaded module: its current instance, whose heap is let go when it has grown too large. */
export class LoadedModule<G> {
  readonly #glue: G & Glue;
  readonly #module: CompiledModule;
  /** The objects in the instance that are more than a copy: while there are any, its heap stays. */
  readonly #kept = new Set<unknown>();
  /** Whether the state of the instance is unknown. */
  #isSpent = false;
  #instance = 0;
  /** Calls on the stack: a listener may call the module again. */
  #depth = 0;

  constructor(glue: G & Glue, module: CompiledModule) {
    this.#glue = glue;
    this.#module = module;
    loaded.add(this);
  }

  /** The number of the current instance; objects of earlier instances are lost. */
  get instance(): number {
    return this.#isSpent ? this.#instance + 1 : this.#instance;
  }

  /**
   * Calls the module. Its errors about the input become {@link Sim3AlignError}s; `rename` maps their argument names to
   * those of the caller. After any other exception, the state of the module is unknown, and it gets a new instance.
   */
  call<T>(work: (glue: G) => T, rename: (argument: string) => string = (argument) => argument): T {
    if (this.#isSpent) this.#renew();
    this.#depth += 1;
    try {
      return work(this.#glue);
    } catch (error) {
      if (isCoded(error)) {
        const { code, argument, found, expected, remedy } = error;
        throw failure(code, rename(argument), found, expected, remedy);
      }
      this.#isSpent = true;
      throw isExhausted(error) ? outOfMemory(error) : internalError(error);
    } finally {
      this.#depth -= 1;
      if (this.#isSpent || !heaps.isBusy) this.letGo();
    }
  }

  /**
   * Calls the module with data that have been read. Since then, other threads may have got their memory, without which the
   * module would trap.
   * @param argument the name of the data in errors
   * @throws {@link Sim3AlignError} `INVALID_ARGUMENT`
   */
  callWith<T>(argument: string, data: unknown, work: (glue: G) => T, rename = withoutInput): T {
    checkAttached(argument, data);
    return this.call(work, rename);
  }

  /** Keeps the instance: this object, or what has this name, lives in it. To be called while the module is called. */
  kept<T>(owner: T): T {
    this.#kept.add(owner);
    return owner;
  }

  /** Ends what {@link kept} has begun. */
  drop(owner: unknown): void {
    this.#kept.delete(owner);
    if (!heaps.isBusy) this.letGo();
  }

  /**
   * Replaces an instance whose state is unknown, or in which nothing is kept and whose heap is too large. If there is no
   * memory for another one, the next call tries again.
   */
  letGo(): void {
    if (this.#depth > 0) return;
    if (!this.#isSpent) {
      if (this.#kept.size > 0) return;
      if (this.#glue.initSync({ module: this.#module }).memory.buffer.byteLength <= MAX_IDLE_HEAP) return;
    }
    try {
      this.#renew();
    } catch {
      this.#isSpent = true;
    }
  }

  #renew(): void {
    this.#kept.clear();
    try {
      this.#glue.__wbg_reset_state();
    } catch (error) {
      throw isExhausted(error) ? outOfMemory(error) : internalError(error);
    }
    this.#isSpent = false;
    this.#instance += 1;
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
