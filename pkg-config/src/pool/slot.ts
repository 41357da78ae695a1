/** A place for a worker of the pool; a worker that fails is replaced. */
import type { Method } from "../calls/calls.js";
import { type ErrorParts, messageOf, Sim3AlignError } from "../error.js";
import type { ModuleName } from "../modules/exports.js";
import type { CompiledModule } from "../modules/module.js";
import type { CreateWorker } from "../platform.js";
import { type Answer, type Instances, isFromWorker, type Report, type Request, type ToWorker } from "./messages.js";
import { type Port, portOf } from "./port.js";

/** The worker terminated or trapped before it answered; the job may be retried. */
export class WorkerLost extends Error {}

/** The message contains a value that cannot be cloned or transferred. */
export class Unsendable extends Error {}

/** A job that failed in a worker, with its returned data. */
export class JobFailed {
  readonly error: Sim3AlignError;
  readonly data: unknown;

  constructor(parts: ErrorParts, data: unknown) {
    this.error = new Sim3AlignError(parts);
    this.data = data;
  }
}

/** What is needed to start a worker, and for what it runs. */
export interface WorkerSetup {
  create: CreateWorker;
  /** Longest time until a worker says that it is ready, milliseconds. */
  startMs: number;
  compiled(name: ModuleName): Promise<CompiledModule>;
}

/** A prepared mesh, and the module that caches it. */
export interface CachedMesh {
  id: number;
  module: ModuleName;
}

interface Pending {
  method: Method | "help";
  resolve(answer: Answer): void;
  reject(reason: unknown): void;
  report(message: Report): void;
}

/** A worker, and what it has got. */
class Hired {
  readonly port: Port;
  readonly modules = new Set<ModuleName>();
  /** By prepared mesh: the modules that have cached it, with their instances. */
  readonly meshes = new Map<number, Map<ModuleName, number>>();
  instances: Instances = {};
  hear = () => {};
  fail = (_reason: unknown) => {};
  /** What the worker says first. */
  readonly ready = new Promise<void>((resolve, reject) => {
    this.hear = resolve;
    this.fail = reject;
  });

  constructor(port: Port) {
    this.port = port;
    // A worker that starts in advance may fail while nothing waits for it.
    this.ready.catch(() => {});
  }

  /** The number of an instance; a module that is not loaded will begin with 0. */
  instance(module: ModuleName): number {
    return this.instances[module] ?? 0;
  }
}

/** A place for a worker. */
export class WorkerSlot {
  readonly #setup: WorkerSetup;
  #worker: Hired | undefined;
  #pending: Pending | undefined;
  /** Prepared meshes that the worker is told to free with its next job. */
  readonly #dropped = new Set<number>();

  constructor(setup: WorkerSetup) {
    this.#setup = setup;
  }

  /** Starts a worker if there is none. A failure surfaces at the next request. */
  start(): void {
    try {
      this.#hired();
    } catch {}
  }

  /**
   * Starts a worker if there is none, and waits until it is ready: a worker of the caller may run another script, which must
   * not get arrays that were moved.
   * @throws {@link WorkerLost}, and the reason passed to `end`
   */
  async ready(): Promise<void> {
    const worker = this.#hired();
    const { startMs } = this.#setup;
    const found = `no answer for ${startMs} ms, which \`workerStartMs\` allows`;
    const timer = setTimeout(() => this.#end(worker, new WorkerLost(found)), startMs);
    worker.port.keepAlive(true);
    try {
      await worker.ready;
    } finally {
      clearTimeout(timer);
      worker.port.keepAlive(false);
    }
  }

  /**
   * Runs a job in the worker, or lets it help another one; one at a time.
   * @param modules the compiled modules that it needs
   * @param mesh the prepared mesh of the job
   * @throws {@link Unsendable}, {@link WorkerLost}, {@link JobFailed}, and the reason passed to `end`
   */
  async request(
    job: Pick<Request, "job" | "wantsProgress" | "returnsData">,
    modules: ReadonlyMap<ModuleName, CompiledModule>,
    transfer: Transferable[],
    report: (message: Report) => void,
    mesh?: CachedMesh,
  ): Promise<Answer> {
    const worker = this.#hired();
    const given = new Map([...modules].filter(([name]) => !worker.modules.has(name)));
    // The job needs its own mesh until its end.
    const droppedMeshes = [...this.#dropped].filter((id) => id !== mesh?.id);
    const instance = mesh && worker.instance(mesh.module);
    try {
      const answer = await new Promise<Answer>((resolve, reject) => {
        // Before the message is sent: its answer, or the end of the worker, may come at once.
        this.#pending = { method: job.job.method, resolve, reject, report };
        try {
          worker.port.post({ type: "job", ...job, modules: given, droppedMeshes }, transfer);
        } catch (cause) {
          throw new Unsendable("a message that cannot be sent", { cause });
        }
        worker.port.keepAlive(true);
        for (const name of given.keys()) worker.modules.add(name);
        for (const id of droppedMeshes) {
          this.#dropped.delete(id);
          worker.meshes.delete(id);
        }
        // A job that fails may leave its mesh there, too.
        if (mesh !== undefined && !worker.meshes.has(mesh.id)) worker.meshes.set(mesh.id, new Map());
      });
      if (mesh !== undefined && instance !== undefined && answer.needs === undefined)
        worker.meshes.get(mesh.id)?.set(mesh.module, instance);
      return answer;
    } finally {
      this.#pending = undefined;
      worker.port.keepAlive(false);
    }
  }

  /** Sends a message that needs no answer, to a worker that may be lost. */
  tell(message: ToWorker, transfer: Transferable[] = []): void {
    this.#worker?.port.post(message, transfer);
  }

  /** Whether the worker has cached this mesh: its arrays need not be sent. */
  hasMesh({ id, module }: CachedMesh): boolean {
    const worker = this.#worker;
    return worker !== undefined && worker.meshes.get(id)?.get(module) === worker.instance(module);
  }

  /** Frees this mesh in the worker, with its next job. */
  dropMesh(id: number): void {
    if (this.#worker?.meshes.has(id)) this.#dropped.add(id);
  }

  /** Terminates the worker and its job. The next request starts another worker. */
  end(reason: unknown): void {
    if (this.#worker !== undefined) this.#end(this.#worker, reason);
  }

  /** Messages of a replaced worker may still arrive. */
  #end(worker: Hired, reason: unknown): void {
    if (worker !== this.#worker) return;
    this.#worker = undefined;
    this.#dropped.clear();
    worker.port.terminate();
    worker.fail(reason);
    this.#pending?.reject(reason);
  }

  #hired(): Hired {
    if (this.#worker !== undefined) return this.#worker;
    try {
      const port = portOf(this.#setup.create(), {
        onMessage: (message) => worker === this.#worker && this.#receive(worker, message),
        onFailure: (description) => this.#end(worker, new WorkerLost(description)),
      });
      const worker = new Hired(port);
      this.#worker = worker;
      return worker;
    } catch (error) {
      throw new WorkerLost(messageOf(error), { cause: error });
    }
  }

  #receive(worker: Hired, message: unknown): void {
    const pending = this.#pending;
    if (!isFromWorker(message, pending?.method)) {
      this.#end(worker, new WorkerLost("a message that worker.js does not send"));
    } else if (message.type === "ready") {
      worker.hear();
    } else if (message.type === "progress") {
      pending?.report(message);
    } else if (message.error?.code === "INTERNAL") {
      // After a trap, the state of the module is unknown, and its memory may be exhausted.
      this.#end(worker, new WorkerLost(message.error.found));
    } else {
      worker.instances = message.instances;
      if (message.error === undefined) pending?.resolve(message);
      else pending?.reject(new JobFailed(message.error, message.data));
    }
  }
}
