/** Worker script: runs the jobs of its aligner one at a time. */
import type { Core } from "./core.js";
import { type ErrorParts, internalError, partsOf, Sim3AlignError } from "./error.js";
import type { Formats } from "./formats-module.js";
import { type MeshCache, perform } from "./jobs.js";
import type { JointAligner } from "./joint-module.js";
import type { LazyName, Reply, Request } from "./pool/protocol.js";
import { buffersOf } from "./pool/transfer.js";
import type { Registrar } from "./registration-module.js";
// Imported statically, because some bundlers put a worker script into a single file without dynamic imports.
import * as coreGlue from "./wasm/core.js";
import * as formatsGlue from "./wasm/formats.js";
import * as jointGlue from "./wasm/joint.js";
import * as registrationGlue from "./wasm/registration.js";
import { type Glue, type LoadedModule, WasmModule } from "./wasm-module.js";

const caches: readonly MeshCache[] = ["core", "joint"];

type Post = (message: Reply, transfer?: ArrayBuffer[]) => void;

interface LazyModule<G extends Glue> {
  load(): Promise<LoadedModule<G>>;
  /** The module, if a job has needed it. */
  loading(): Promise<LoadedModule<G>> | undefined;
}

/** Loads the modules and runs the jobs of one worker. */
class WorkerHost {
  readonly #post: Post;
  #core: Promise<LoadedModule<Core>> | undefined;
  readonly #formats = this.#lazy<Formats>("formats", formatsGlue);
  readonly #registrar = this.#lazy<Registrar>("registration", registrationGlue as unknown as Registrar);
  readonly #joint = this.#lazy<JointAligner>("joint", jointGlue as unknown as JointAligner);
  /** Receives the answer to `needs-module`. */
  #receiveModule: ((module: WebAssembly.Module | ErrorParts) => void) | undefined;

  constructor(post: Post) {
    this.#post = post;
  }

  receive(message: Request): void {
    if (message.type === "module") this.#receiveModule?.(message.module);
    else if (message.type === "start") this.#start(message.core);
    else if (message.type === "drop-mesh") this.#dropMesh(message.id);
    else this.#run(message);
  }

  #start(core: WebAssembly.Module): void {
    this.#core = this.#loadCore(core);
    this.#post({ type: "ready" });
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

  async #answer(request: Request & { type: "job" }): Promise<Reply & { type: "done" }> {
    const before = await this.#instances();
    const answer = await this.#performed(request);
    const after = await this.#instances();
    return {
      ...answer,
      emptied: caches.filter((cache) => before[cache] !== undefined && before[cache] !== after[cache]),
    };
  }

  /** The numbers of the current instances of the modules that cache meshes, of those that are loaded. */
  async #instances(): Promise<Partial<Record<MeshCache, number>>> {
    const [core, joint] = await Promise.all(
      [this.#core, this.#joint.loading()].map((it) => it?.catch(() => undefined)),
    );
    return { ...(core && { core: core.instance }), ...(joint && { joint: joint.instance }) };
  }

  async #performed({ job, wantsProgress }: Request & { type: "job" }): Promise<Reply & { type: "done" }> {
    const listener = (stage: (Reply & { type: "progress" })["stage"], fraction: number, best?: Float64Array) =>
      this.#post({ type: "progress", stage, fraction, best });
    try {
      const core = await this.#core?.catch((error) => {
        // The pool replaces a worker with an internal error; this one would fail forever.
        throw internalError(error);
      });
      if (core === undefined) throw new Error("no core");
      const modules = { core, formats: this.#formats.load, registrar: this.#registrar.load, joint: this.#joint.load };
      return { type: "done", result: await perform(job, modules, wantsProgress ? listener : undefined) };
    } catch (error) {
      return { type: "done", error: partsOf(error instanceof Sim3AlignError ? error : internalError(error)) };
    }
  }

  async #dropMesh(id: number): Promise<void> {
    // If the core could not be loaded, the next job fails.
    (await this.#core?.catch(() => undefined))?.call((core) => core.dropMesh(id));
    (await this.#joint.loading()?.catch(() => undefined))?.call((joint) => joint.dropMesh(id));
  }

  #loadCore(module: WebAssembly.Module): Promise<LoadedModule<Core>> {
    const core = new WasmModule<Core>("core", module, () => coreGlue as unknown as Core).load();
    // The failure surfaces at the first job.
    core.catch(() => {});
    return core;
  }

  /** A module that is loaded when a job first needs it; after a failure, the next job tries again. */
  #lazy<G extends Glue>(name: LazyName, glue: G): LazyModule<G> {
    let loading: Promise<LoadedModule<G>> | undefined;
    const load = () => {
      if (loading === undefined) {
        loading = this.#request(name).then((module) => new WasmModule<G>(name, module, () => glue).load());
        loading.catch(() => {
          loading = undefined;
        });
      }
      return loading;
    };
    return { load, loading: () => loading };
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
