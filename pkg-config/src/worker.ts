/** Worker script: runs the jobs of its aligner one at a time. */
import type { Core } from "./core.js";
import { type ErrorParts, internalError, partsOf, Sim3AlignError } from "./error.js";
import type { Formats } from "./formats-module.js";
import { perform } from "./jobs.js";
import type { Reply, Request } from "./pool/protocol.js";
import { buffersOf } from "./pool/transfer.js";
// Imported statically, because some bundlers put a worker script into a single file without dynamic imports.
import * as coreGlue from "./wasm/core.js";
import * as formatsGlue from "./wasm/formats.js";
import { type LoadedModule, WasmModule } from "./wasm-module.js";

type Post = (message: Reply, transfer?: ArrayBuffer[]) => void;

/** Loads the modules and runs the jobs of one worker. */
class WorkerHost {
  readonly #post: Post;
  #core: Promise<LoadedModule<Core>> | undefined;
  #formats: Promise<LoadedModule<Formats>> | undefined;
  /** Receives the answer to `needs-formats`. */
  #receiveFormats: ((formats: WebAssembly.Module | ErrorParts) => void) | undefined;

  constructor(post: Post) {
    this.#post = post;
  }

  receive(message: Request): void {
    if (message.type === "formats") this.#receiveFormats?.(message.formats);
    else if (message.type === "start") this.#core = this.#loadCore(message.core);
    else if (message.type === "drop-mesh") this.#dropMesh(message.id);
    else this.#run(message);
  }

  /** Reports a message whose content could not be read, so that its call does not wait forever. */
  receiveUnreadable(): void {
    this.#post({ type: "unreadable" });
  }

  async #run(request: Request & { type: "job" }): Promise<void> {
    const data = request.returnData ? request.job.data : undefined;
    const answer = await this.#answer(request);
    try {
      this.#post({ ...answer, data }, buffersOf(data));
    } catch (error) {
      this.#post({ type: "done", error: partsOf(internalError(error)) });
    }
  }

  async #answer({ job, wantsProgress }: Request & { type: "job" }): Promise<Reply & { type: "done" }> {
    const listener = (stage: (Reply & { type: "progress" })["stage"], fraction: number, best?: Float64Array) =>
      this.#post({ type: "progress", stage, fraction, best });
    try {
      const core = await this.#core?.catch((error) => {
        // The pool replaces a worker with an internal error; this one would fail forever.
        throw internalError(error);
      });
      if (core === undefined) throw new Error("no core");
      const modules = { core, formats: () => this.#loadFormats() };
      return { type: "done", result: await perform(job, modules, wantsProgress ? listener : undefined) };
    } catch (error) {
      return { type: "done", error: partsOf(error instanceof Sim3AlignError ? error : internalError(error)) };
    }
  }

  async #dropMesh(id: number): Promise<void> {
    // If the core could not be loaded, the next job fails.
    (await this.#core?.catch(() => undefined))?.call((core) => core.dropMesh(id));
  }

  #loadCore(module: WebAssembly.Module): Promise<LoadedModule<Core>> {
    const core = new WasmModule<Core>("core", module, () => coreGlue as unknown as Core).load();
    // The failure surfaces at the first job.
    core.catch(() => {});
    return core;
  }

  #loadFormats(): Promise<LoadedModule<Formats>> {
    if (this.#formats === undefined) {
      const loading = this.#requestFormats();
      this.#formats = loading;
      loading.catch(() => {
        this.#formats = undefined;
      });
    }
    return this.#formats;
  }

  async #requestFormats(): Promise<LoadedModule<Formats>> {
    const formats = await new Promise<WebAssembly.Module | ErrorParts>((resolve) => {
      this.#receiveFormats = resolve;
      this.#post({ type: "needs-formats" });
    });
    this.#receiveFormats = undefined;
    if ("code" in formats) throw new Sim3AlignError(formats);
    return new WasmModule<Formats>("formats", formats, () => formatsGlue).load();
  }
}

/** The parts of a worker's global scope that this script uses. Node worker threads have a module instead. */
const scope = globalThis as unknown as {
  postMessage?: (message: Reply, transfer: ArrayBuffer[]) => void;
  onmessage?: (event: { data: Request }) => void;
  onmessageerror?: () => void;
};

if (typeof scope.postMessage === "function") {
  const host = new WorkerHost((message, transfer = []) => scope.postMessage?.(message, transfer));
  scope.onmessage = ({ data }) => host.receive(data);
  scope.onmessageerror = () => host.receiveUnreadable();
} else {
  // The name is in a variable, so that browser bundlers do not resolve it. Messages are queued until there is a
  // listener.
  const name = "node:worker_threads";
  import(/* webpackIgnore: true */ /* @vite-ignore */ name).then(
    ({ parentPort }: typeof import("node:worker_threads")) => {
      const host = new WorkerHost((message, transfer = []) => parentPort?.postMessage(message, transfer));
      parentPort?.on("message", (message: Request) => host.receive(message));
      parentPort?.on("messageerror", () => host.receiveUnreadable());
    },
  );
}
