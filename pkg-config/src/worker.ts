/** Worker script: runs the jobs of its aligner, or helps another worker with one, one at a time. */
import { dropMesh, perform } from "./calls/calls.js";
import { JobContext } from "./calls/context.js";
import type { Stage } from "./generated/types.js";
import type { Exports, ModuleName } from "./modules/exports.js";
import { type CompiledModule, type LoadedModule, type ModuleTable, modulesBy, WasmModule } from "./modules/module.js";
import { HelperSession, Helpers } from "./pool/helpers.js";
import type { Answer, FromWorker, Request, ToWorker } from "./pool/messages.js";
import { internalError, partsOf, Sim3AlignError } from "./values/error.js";
import { buffersOf } from "./values/transfer.js";
// Imported statically, because some bundlers put a worker script into a single file without dynamic imports.
import * as coreGlue from "./wasm/core.js";
import * as depthFilesGlue from "./wasm/depth-files.js";
import * as formatsGlue from "./wasm/formats.js";
import * as jointGlue from "./wasm/joint.js";
import * as registrationGlue from "./wasm/registration.js";
import * as splatsGlue from "./wasm/splats.js";
import * as webpGlue from "./wasm/webp.js";

type Post = (message: FromWorker, transfer?: ArrayBuffer[]) => void;

/** A module that the worker has not got: the pool sends it with the job, once more. */
class Missing {
  constructor(readonly module: ModuleName) {}
}

/** Runs the jobs of one worker. */
class WorkerHost {
  /** The compiled modules that have come with jobs. */
  readonly #compiled = new Map<ModuleName, CompiledModule>();
  readonly #table: ModuleTable = {
    core: this.#module("core", coreGlue),
    formats: this.#module("formats", formatsGlue),
    depthFiles: this.#module("depthFiles", depthFilesGlue),
    splats: this.#module("splats", splatsGlue),
    webp: this.#module("webp", webpGlue),
    joint: this.#module("joint", jointGlue),
    registration: this.#module("registration", registrationGlue),
  };
  readonly #modules = modulesBy((name) => this.#loaded(name));
  /** The helpers of the running job. */
  #helpers: Helpers | undefined;
  /** The help that this worker gives. */
  #session: HelperSession | undefined;

  constructor(private readonly post: Post) {}

  receive(message: ToWorker): void {
    if (message.type === "job") this.#answer(message);
    else if (message.type === "stop") this.#session?.stop();
    else if (this.#helpers !== undefined) this.#helpers.change(message.helper, message.port);
    // The job has ended in the meantime.
    else message.port?.close();
  }

  /** Reports a message whose content could not be read, so that its call does not wait forever. */
  receiveUnreadable(): void {
    this.post(this.#failed(new Error("a message that the worker could not read")));
  }

  async #answer(request: Request): Promise<void> {
    const data = request.returnsData && "data" in request.job ? request.job.data : undefined;
    const answer = await this.#run(request).catch((error) => this.#failed(error));
    try {
      this.post({ ...answer, data }, buffersOf(data));
    } catch (error) {
      this.post(this.#failed(error));
    }
  }

  async #run(request: Request): Promise<Answer> {
    for (const [name, module] of request.modules) this.#compiled.set(name, module);
    for (const id of request.droppedMeshes) dropMesh(id, this.#table);
    const result = await this.#performed(request);
    return { type: "result", result, instances: this.#instances() };
  }

  async #performed({ job, wantsProgress }: Request): Promise<unknown> {
    if (job.method === "start") return {};
    if (job.method === "help") {
      this.#session = new HelperSession(job.data);
      await this.#session.run(this.#modules);
      return {};
    }
    const helpers = new Helpers(() => this.post({ type: "progress" }));
    this.#helpers = helpers;
    const listener = (stage: Stage, fraction: number, best?: Float64Array) =>
      this.post({ type: "progress", stage, fraction, best });
    try {
      return await perform(job, new JobContext(this.#modules, helpers, wantsProgress ? listener : undefined));
    } finally {
      this.#helpers = undefined;
      helpers.close();
    }
  }

  #failed(error: unknown): Answer {
    const instances = this.#instances();
    if (error instanceof Missing) return { type: "result", needs: error.module, instances };
    const known = error instanceof Sim3AlignError ? error : internalError(error);
    return { type: "result", error: partsOf(known), instances };
  }

  /** The numbers of the instances of the modules that cache meshes. */
  #instances(): Answer["instances"] {
    const { core, joint } = this.#table;
    return { core: core.loaded?.instance, joint: joint.loaded?.instance };
  }

  #module<N extends ModuleName>(name: N, glue: object): WasmModule<Exports[N]> {
    return new WasmModule(
      name,
      () => this.#compiled.get(name) as CompiledModule,
      () => glue,
    );
  }

  async #loaded<N extends ModuleName>(name: N): Promise<LoadedModule<Exports[N]>> {
    if (!this.#compiled.has(name)) throw new Missing(name);
    return this.#table[name].load();
  }
}

/** The parts of a worker's global scope that this script uses. Node worker threads have a module instead. */
const scope = globalThis as unknown as {
  postMessage?: (message: FromWorker, transfer: ArrayBuffer[]) => void;
  onmessage?: (event: { data: ToWorker }) => void;
  onmessageerror?: () => void;
};

if (typeof scope.postMessage === "function") {
  const host = new WorkerHost((message, transfer = []) => scope.postMessage?.(message, transfer));
  scope.onmessage = ({ data }) => host.receive(data);
  scope.onmessageerror = () => host.receiveUnreadable();
} else {
  // The name is an argument, so that browser bundlers do not resolve it. Messages are queued until there is a listener.
  const nodeModule = (name: string) => import(/* webpackIgnore: true */ /* @vite-ignore */ name);
  nodeModule("node:worker_threads").then(({ parentPort }: typeof import("node:worker_threads")) => {
    const host = new WorkerHost((message, transfer = []) => parentPort?.postMessage(message, transfer));
    parentPort?.on("message", (message: ToWorker) => host.receive(message));
    parentPort?.on("messageerror", () => host.receiveUnreadable());
  });
}
