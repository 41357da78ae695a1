/** The worker of a pool, as an object of the thread of the pool. */
import type { ModuleName } from "../modules/exports.js";
import type { CompiledModule } from "../modules/module.js";
import type { CreateWorker } from "../types/platform.js";
import { messageOf } from "../values/error.js";
import { type Answer, type Instances, isFromWorker, type Report, type Request, type ToWorker } from "./messages.js";
import { type Port, portOf } from "./port.js";

/** The worker terminated or trapped before it answered; the job may be retried. */
export class WorkerLost extends Error {}

/** Settings of starting and running a worker. */
export interface WorkerSetup {
  create: CreateWorker;
  /** Longest time until the ready message of a worker, milliseconds. */
  startMs: number;
  compiled(name: ModuleName): Promise<CompiledModule>;
}

/** A prepared mesh, and the module that caches it. */
export interface CachedMesh {
  id: number;
  module: ModuleName;
}

interface Pending {
  method: Request["job"]["method"];
  resolve(answer: Answer): void;
  reject(reason: unknown): void;
  report: JobMessage["report"];
}

/** Parts of a message with a job. */
export interface JobMessage extends Pick<Request, "job" | "wantsProgress" | "returnsData"> {
  transfer?: Transferable[];
  /** The compiled modules that it needs. */
  modules?: ReadonlyMap<ModuleName, CompiledModule>;
  /** Its prepared mesh. */
  mesh?: CachedMesh | undefined;
  report?(message: Report): void;
}

/** A worker of the pool, until it ends. */
export class PoolWorker {
  readonly #startMs: number;
  readonly #port: Port | undefined;
  readonly #started: Promise<unknown>;
  /** Why it has ended. */
  #end: { reason: unknown } | undefined;
  #pending: Pending | undefined;
  /** The modules that it has got. */
  readonly #modules = new Set<ModuleName>();
  /** By prepared mesh: the modules that have cached it, with the numbers of their instances. */
  readonly #meshes = new Map<number, Map<ModuleName, number>>();
  /** Prepared meshes that it frees with its next job. */
  readonly #dropped = new Set<number>();
  #instances: Instances = {};

  /** Starts a worker. A failure surfaces at the first request. */
  constructor({ create, startMs }: WorkerSetup) {
    this.#startMs = startMs;
    try {
      this.#port = portOf(create(), {
        onMessage: (message) => this.#receive(message),
        onFailure: (description) => this.end(new WorkerLost(description)),
      });
    } catch (error) {
      this.end(new WorkerLost(messageOf(error), { cause: error }));
    }
    this.#started = this.request({ job: { method: "start" } });
    // It may fail while nothing waits for it.
    this.#started.catch(() => {});
  }

  get hasEnded(): boolean {
    return this.#end !== undefined;
  }

  /**
   * Waits until it has started: a worker of the caller may run another script, which must not get arrays that were moved.
   * @throws {@link WorkerLost}, and the reason passed to `end`
   */
  async ready(): Promise<void> {
    const found = `no answer for ${this.#startMs} ms, which \`workerStartMs\` allows`;
    const timer = setTimeout(() => this.end(new WorkerLost(found)), this.#startMs);
    this.#port?.keepAlive(true);
    try {
      await this.#started;
    } finally {
      clearTimeout(timer);
      this.#port?.keepAlive(false);
    }
  }

  /**
   * Runs a job, or lets the worker help another one; one at a time. Returns `undefined` for a job that cannot be cloned or
   * transferred.
   * @throws {@link WorkerLost}, and the reason passed to `end`
   */
  async request({ transfer, modules = new Map(), mesh, report, ...job }: JobMessage): Promise<Answer | undefined> {
    const missing = new Map([...modules].filter(([name]) => !this.#modules.has(name)));
    // The job needs its mesh until its end.
    const droppedMeshes = [...this.#dropped].filter((id) => id !== mesh?.id);
    const instance = mesh && this.#instance(mesh.module);
    try {
      const answer = await new Promise<Answer | undefined>((resolve, reject) => {
        if (this.#end !== undefined) throw this.#end.reason;
        // Before the message is sent: its answer, or the end of the worker, may come at once.
        this.#pending = { method: job.job.method, resolve, reject, report };
        try {
          this.#port?.post({ type: "job", ...job, modules: missing, droppedMeshes }, transfer);
        } catch {
          resolve(undefined);
          return;
        }
        if (job.job.method !== "start") this.#port?.keepAlive(true);
        for (const name of missing.keys()) this.#modules.add(name);
        for (const id of droppedMeshes) {
          this.#dropped.delete(id);
          this.#meshes.delete(id);
        }
        // A job that fails may leave its mesh there, too.
        if (mesh !== undefined && !this.#meshes.has(mesh.id)) this.#meshes.set(mesh.id, new Map());
      });
      const isCached = answer !== undefined && answer.error === undefined && answer.needs === undefined;
      if (mesh !== undefined && instance !== undefined && isCached) {
        this.#meshes.get(mesh.id)?.set(mesh.module, instance);
      }
      return answer;
    } finally {
      this.#pending = undefined;
      this.#port?.keepAlive(false);
    }
  }

  /** Sends a message that needs no answer. */
  post(message: ToWorker, transfer: Transferable[] = []): void {
    if (this.#end === undefined) this.#port?.post(message, transfer);
  }

  /** Whether it has cached this mesh, whose arrays then need not be sent. */
  hasMesh({ id, module }: CachedMesh): boolean {
    return this.#meshes.get(id)?.get(module) === this.#instance(module);
  }

  /** Frees this mesh with the next job. */
  dropMesh(id: number): void {
    if (this.#meshes.has(id)) this.#dropped.add(id);
  }

  /** Terminates it and its job. */
  end(reason: unknown): void {
    if (this.#end !== undefined) return;
    this.#end = { reason };
    this.#port?.terminate();
    this.#pending?.reject(reason);
  }

  /** The number of the instance of a module; one that is not loaded will begin with 0. */
  #instance(module: ModuleName): number {
    return this.#instances[module] ?? 0;
  }

  #receive(message: unknown): void {
    if (this.#end !== undefined) return;
    const pending = this.#pending;
    if (!isFromWorker(message) || pending === undefined) {
      this.end(new WorkerLost("a message that worker.js does not send"));
    } else if (message.type === "progress") {
      pending.report?.(message);
    } else if (message.error?.code === "INTERNAL") {
      // After a trap, the state of the module is unknown, and its memory may be exhausted.
      this.end(new WorkerLost(message.error.found));
    } else {
      this.#instances = message.instances;
      pending.resolve(message);
    }
  }
}

/** A place in the pool, whose worker is replaced when it has ended. */
export class Slot {
  #worker: PoolWorker;

  constructor(private readonly setup: WorkerSetup) {
    this.#worker = new PoolWorker(setup);
  }

  /** Its worker, which may have ended. */
  get last(): PoolWorker {
    return this.#worker;
  }

  /** Its worker, or another one if that has ended. */
  ensureWorker(): PoolWorker {
    if (this.#worker.hasEnded) this.#worker = new PoolWorker(this.setup);
    return this.#worker;
  }
}
