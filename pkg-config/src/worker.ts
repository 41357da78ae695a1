/** Worker script: runs the jobs of its aligner, or helps another worker with one, one at a time. */
import type { Core } from "./core.js";
import type { DepthFiles } from "./depth-files-module.js";
import { type ErrorParts, internalError, partsOf, Sim3AlignError } from "./error.js";
import type { Formats } from "./formats-module.js";
import { type Job, type MeshCache, type Modules, perform } from "./jobs.js";
import type { JointAligner } from "./joint-module.js";
import { HelpingWorker } from "./pool/helper.js";
import { Helpers } from "./pool/helpers.js";
import type { LazyName, Reply, Request } from "./pool/protocol.js";
import { buffersOf } from "./pool/transfer.js";
import type { Registrar } from "./registration-module.js";
import type { Splats } from "./splats-module.js";
// Imported statically, because some bundlers put a worker script into a single file without dynamic imports.
import * as coreGlue from "./wasm/core.js";
import * as depthFilesGlue from "./wasm/depth-files.js";
import * as formatsGlue from "./wasm/formats.js";
import * as jointGlue from "./wasm/joint.js";
import * as registrationGlue from "./wasm/registration.js";
import * as splatsGlue from "./wasm/splats.js";
import { type Glue, type LoadedModule, WasmModule } from "./wasm-module.js";

const caches: readonly MeshCache[] = ["core", "joint"];

type Post = (message: Reply, transfer?: ArrayBuffer[]) => void;

/** Loads the modules and runs the jobs of one worker. */
class WorkerHost {
  readonly #post: Post;
  #core: WasmModule<Core> | undefined;
  readonly #formats = this.#lazy<Formats>("formats", formatsGlue);
  readonly #depthFiles = this.#lazy<DepthFiles>("depthFiles", depthFilesGlue as unknown as DepthFiles);
  readonly #splats = this.#lazy<Splats>("splats", splatsGlue as unknown as Splats);
  readonly #registrar = this.#lazy<Registrar>("registration", registrationGlue as unknown as Registrar);
  readonly #joint = this.#lazy<JointAligner>("joint", jointGlue as unknown as JointAligner);
  /** The helpers of the running job. */
  #helpers: Helpers | undefined;
  /** The help that this worker gives. */
  #help: HelpingWorker | undefined;
  /** Receives the answer to `needs-module`. */
  #receiveModule: ((module: WebAssembly.Module | ErrorParts) => void) | undefined;

  constructor(post: Post) {
    this.#post = post;
  }

  receive(message: Request): void {
    if (message.type === "module") this.#receiveModule?.(message.module);
    else if (message.type === "start") this.#start(message.core);
    else if (message.type === "drop-mesh") this.#dropMesh(message.id);
    else if (message.type === "helper") this.#addHelper(message.port);
    else if (message.type === "helper-left") this.#helpers?.remove(message.helper);
    else if (message.type === "stop-helping") this.#help?.stop();
    else if (message.type === "help") this.#answer(this.#helping(message));
    else this.#answer(this.#performed(message), message.returnData ? message.job.data : undefined);
  }

  #start(core: WebAssembly.Module): void {
    this.#core = new WasmModule<Core>("core", core, () => coreGlue as unknown as Core);
    // The failure surfaces at the first job.
    this.#core.load().catch(() => {});
    this.#post({ type: "ready" });
  }

  /** Reports a message whose content could not be read, so that its call does not wait forever. */
  receiveUnreadable(): void {
    this.#post({ type: "unreadable" });
  }

  /** @param data the data that are returned with the result */
  async #answer(work: (modules: Modules) => Promise<unknown>, data?: unknown): Promise<void> {
    const instances = async () => (await this.#caching()).map((module) => module?.instance);
    const before = await instances();
    const answer = await this.#done(work);
    const after = await instances();
    const emptied = caches.filter((_, i) => before[i] !== undefined && before[i] !== after[i]);
    try {
      this.#post({ ...answer, data, emptied }, buffersOf(data));
    } catch (error) {
      this.#post({ type: "done", error: partsOf(internalError(error)) });
    }
  }

  /** The module of each cache of meshes, if it is loaded. */
  #caching(): Promise<(LoadedModule<Core | JointAligner> | undefined)[]> {
    return Promise.all([this.#core, this.#joint].map((module) => module?.loading?.catch(() => undefined)));
  }

  #performed({ job, wantsProgress }: Request & { type: "job" }): (modules: Modules) => Promise<unknown> {
    const listener = (stage: (Reply & { type: "progress" })["stage"], fraction: number, best?: Float64Array) =>
      this.#post({ type: "progress", stage, fraction, best });
    return async (modules) => {
      const helpers = new Helpers(() => this.#post({ type: "needs-help" }));
      this.#helpers = helpers;
      try {
        return await perform<Job>(job, modules, wantsProgress ? listener : undefined, helpers);
      } finally {
        this.#helpers = undefined;
        helpers.close();
      }
    };
  }

  #helping({ port, mesh }: Request & { type: "help" }): (modules: Modules) => Promise<unknown> {
    const help = new HelpingWorker(port, mesh);
    this.#help = help;
    return async (modules) => {
      await help.run(modules);
      return {};
    };
  }

  /** Connects a helper to the running job, which may have ended in the meantime. */
  #addHelper(port: MessagePort): void {
    if (this.#helpers === undefined) port.close();
    else this.#helpers.add(port);
  }

  async #done(work: (modules: Modules) => Promise<unknown>): Promise<Reply & { type: "done" }> {
    try {
      const core = await this.#core?.load().catch((error) => {
        // The pool replaces a worker with an internal error; this one would fail forever.
        throw internalError(error);
      });
      if (core === undefined) throw new Error("no core");
      const modules = {
        core,
        formats: () => this.#formats.load(),
        depthFiles: () => this.#depthFiles.load(),
        splats: () => this.#splats.load(),
        registrar: () => this.#registrar.load(),
        joint: () => this.#joint.load(),
      };
      return { type: "done", result: await work(modules) };
    } catch (error) {
      return { type: "done", error: partsOf(error instanceof Sim3AlignError ? error : internalError(error)) };
    }
  }

  async #dropMesh(id: number): Promise<void> {
    for (const module of await this.#caching()) module?.call((glue) => glue.dropMesh(id));
  }

  /** A module that is loaded when a job first needs it. */
  #lazy<G extends Glue>(name: LazyName, glue: G): WasmModule<G> {
    return new WasmModule<G>(
      name,
      () => this.#request(name),
      () => glue,
    );
  }

  /** Asks the pool for a compiled module. The worker runs one job at a time, and so asks for one at a time. */
  async #request(name: LazyName): Promise<WebAssembly.Module> {
    const module = await new Promise<WebAssembly.Module | ErrorParts>((resolve) => {
      this.#receiveModule = resolve;
      this.#post({ type: "needs-module", name });
    });
    this.#receiveModule = undefined;
    if ("code" in module) throw new Sim3AlignError(module);
    return module;
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
