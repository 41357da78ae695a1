/** A worker slot of the pool; a failed worker is replaced. */
import { type ErrorParts, messageOf, partsOf, Sim3AlignError } from "../error.js";
import type { MeshCache } from "../jobs.js";
import type { CreateWorker } from "../platform.js";
import type { ProgressListener } from "../progress.js";
import { type Port, portOf } from "./port.js";
import { isReply, type LazyName, type Request } from "./protocol.js";

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

/** The result of a job, and its data if requested. */
export interface Answer {
  result: unknown;
  data?: unknown;
  /** The caches of meshes that the worker has lost. */
  emptied?: readonly MeshCache[];
}

/** Everything a slot needs to start a worker. */
export interface WorkerSetup extends Record<LazyName, () => Promise<WebAssembly.Module>> {
  create: CreateWorker;
  core: WebAssembly.Module;
  /** Longest time until a worker says that it is ready, milliseconds. */
  startMs: number;
}

/** Who hears what a worker says while it runs a job. */
export interface Listeners {
  progress: ProgressListener;
  /** Called when the job would be faster with helpers. */
  onNeedsHelp?(): void;
}

interface Pending {
  resolve(answer: Answer): void;
  reject(reason: unknown): void;
  listeners: Listeners;
  /** Whether the job has a result; all but the opening of a tracker have one, an object. */
  hasResult: boolean;
}

/** What a worker says first. */
class Greeting {
  hear = () => {};
  fail = (_reason: unknown) => {};
  readonly heard = new Promise<void>((resolve, reject) => {
    this.hear = resolve;
    this.fail = reject;
  });

  constructor() {
    // A worker that starts in advance may fail while nothing waits for it.
    this.heard.catch(() => {});
  }
}

/** A slot for a worker. */
export class WorkerSlot {
  readonly #setup: WorkerSetup;
  #port: Port | undefined;
  #greeting: Greeting | undefined;
  #pending: Pending | undefined;
  /**
   * The ids of the prepared meshes that were sent to the worker, and the modules that are known to hold them there: it may
   * also hold one of a job that failed.
   */
  readonly #meshes = new Map<number, Set<MeshCache>>();
  /** The ids of meshes to free when the running job is done. */
  readonly #dropped: number[] = [];

  constructor(setup: WorkerSetup) {
    this.#setup = setup;
  }

  /** Starts a worker if there is none. A failure surfaces at the next request. */
  start(): Port {
    if (this.#port !== undefined) return this.#port;
    const port = portOf(this.#setup.create(), {
      // Messages of a replaced worker may still arrive.
      onMessage: (message) => this.#isCurrent(port) && this.#receive(message, port),
      onFailure: (description) => this.#isCurrent(port) && this.end(new WorkerLost(description)),
    });
    this.#port = port;
    this.#greeting = new Greeting();
    this.#meshes.clear();
    try {
      port.post({ type: "start", core: this.#setup.core });
    } catch (error) {
      // A worker without core could not run any job.
      this.end(error);
      throw error;
    }
    return port;
  }

  /**
   * Starts a worker if there is none, and waits until it is ready: a worker of the caller may run another script, which must
   * not get arrays that were moved.
   * @throws {@link WorkerLost}, and the reason passed to `end`
   */
  async ready(): Promise<void> {
    const port = this.#started();
    const { startMs } = this.#setup;
    const found = `no answer for ${startMs} ms, which \`workerStartMs\` allows`;
    const timer = setTimeout(() => this.#isCurrent(port) && this.end(new WorkerLost(found)), startMs);
    port.keepAlive(true);
    try {
      await this.#greeting?.heard;
    } finally {
      clearTimeout(timer);
      port.keepAlive(false);
    }
  }

  /**
   * Runs a job in the worker, or lets it help another one; one at a time.
   * @param mesh the prepared mesh of the job, and the module that caches it
   * @throws {@link Unsendable}, {@link WorkerLost}, {@link JobFailed}, and the reason passed to `end`
   */
  async request(
    message: Request & { type: "job" | "help" },
    transfer: Transferable[],
    listeners: Listeners,
    mesh?: { id: number; cache: MeshCache },
  ): Promise<Answer> {
    const port = this.#started();
    try {
      const answer = await new Promise<Answer>((resolve, reject) => {
        // Before the message is sent: its answer, or the end of the worker, may come at once.
        const hasResult = message.type === "help" || message.job.method !== "openTracker";
        this.#pending = { resolve, reject, listeners, hasResult };
        try {
          port.post(message, transfer);
        } catch (cause) {
          throw new Unsendable("a message that cannot be sent", { cause });
        }
        port.keepAlive(true);
        if (mesh !== undefined && !this.#meshes.has(mesh.id)) this.#meshes.set(mesh.id, new Set());
      });
      const isKept = mesh !== undefined && this.#isCurrent(port) && !answer.emptied?.includes(mesh.cache);
      if (isKept) this.#meshes.get(mesh.id)?.add(mesh.cache);
      return answer;
    } finally {
      this.#pending = undefined;
      port.keepAlive(false);
      for (const id of this.#dropped.splice(0)) this.dropMesh(id);
    }
  }

  /** Sends a message that needs no answer, to a worker that may be lost. */
  tell(message: Request, transfer: Transferable[] = []): void {
    this.#port?.post(message, transfer);
  }

  /** Whether the worker holds this mesh in this module: its arrays need not be sent. */
  hasMesh(id: number, cache: MeshCache): boolean {
    return this.#port !== undefined && this.#meshes.get(id)?.has(cache) === true;
  }

  /** Frees this mesh in the worker. */
  dropMesh(id: number): void {
    // The running job may need the mesh.
    if (this.#pending !== undefined) {
      this.#dropped.push(id);
      return;
    }
    if (!this.#meshes.delete(id)) return;
    try {
      this.#port?.post({ type: "drop-mesh", id });
    } catch (error) {
      // The mesh ends with its worker.
      this.end(error);
    }
  }

  /** Terminates the worker and its job. The next request starts another worker. */
  end(reason: unknown): void {
    const port = this.#port;
    this.#port = undefined;
    port?.terminate();
    this.#greeting?.fail(reason);
    this.#pending?.reject(reason);
  }

  #isCurrent = (port: Port) => this.#port === port;

  #started(): Port {
    try {
      return this.start();
    } catch (error) {
      throw new WorkerLost(messageOf(error), { cause: error });
    }
  }

  #receive(message: unknown, port: Port): void {
    if (!isReply(message, this.#pending?.hasResult)) {
      this.end(new WorkerLost("a message that worker.js does not send"));
    } else if (message.type === "ready") {
      this.#greeting?.hear();
    } else if (message.type === "progress") {
      this.#pending?.listeners.progress.report(message.stage, message.fraction, message.best);
    } else if (message.type === "needs-help") {
      this.#pending?.listeners.onNeedsHelp?.();
    } else if (message.type === "needs-module") {
      const lost = (error: unknown) => this.#isCurrent(port) && this.end(new WorkerLost(messageOf(error)));
      this.#sendModule(message.name, port).catch(lost);
    } else if (message.type === "unreadable") {
      this.end(new WorkerLost("a message that the worker could not read"));
    } else if (message.error === undefined) {
      this.#forget(message.emptied);
      this.#pending?.resolve(message);
    } else if (message.error.code === "INTERNAL") {
      // After a trap, the state of the module is unknown, and its memory may be exhausted.
      this.end(new WorkerLost(message.error.found));
    } else {
      this.#forget(message.emptied);
      this.#pending?.reject(new JobFailed(message.error, message.data));
    }
  }

  /** Forgets what was in these caches: the next jobs bring their meshes again. */
  #forget(emptied: readonly MeshCache[] = []): void {
    for (const caches of this.#meshes.values()) for (const cache of emptied) caches.delete(cache);
  }

  async #sendModule(name: LazyName, port: Port): Promise<void> {
    const module = await this.#setup[name]().catch((error) => {
      if (error instanceof Sim3AlignError) return partsOf(error);
      throw error;
    });
    port.post({ type: "module", name, module });
  }
}
