/** A worker slot of the pool; a failed worker is replaced. */
import { type ErrorParts, partsOf, Sim3AlignError } from "../error.js";
import type { CreateWorker } from "../platform.js";
import type { ProgressListener } from "../progress.js";
import { type Port, portOf } from "./port.js";
import type { Reply, Request } from "./protocol.js";

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
}

/** Everything a slot needs to start a worker. */
export interface WorkerSetup {
  create: CreateWorker;
  core: WebAssembly.Module;
  formats(): Promise<WebAssembly.Module>;
}

interface Pending {
  resolve(answer: Answer): void;
  reject(reason: unknown): void;
  progress: ProgressListener;
}

/** A slot for a worker. */
export class WorkerSlot {
  readonly #setup: WorkerSetup;
  #port: Port | undefined;
  #pending: Pending | undefined;
  /** The ids of the prepared meshes that the worker holds. */
  readonly #meshes = new Set<number>();

  constructor(setup: WorkerSetup) {
    this.#setup = setup;
  }

  /** Starts a worker if there is none. A failure surfaces at the next request. */
  start(): Port {
    if (this.#port !== undefined) return this.#port;
    // Messages of a replaced worker may still arrive.
    const ifCurrent = (act: () => void) => {
      if (this.#port === port) act();
    };
    const port = portOf(this.#setup.create(), {
      onMessage: (message) => ifCurrent(() => this.#receive(message, port)),
      onFailure: (description) => ifCurrent(() => this.end(new WorkerLost(description))),
    });
    this.#port = port;
    this.#meshes.clear();
    port.post({ type: "start", core: this.#setup.core });
    return port;
  }

  /**
   * Runs a job in the worker; one at a time.
   * @throws {@link Unsendable}, {@link WorkerLost}, {@link JobFailed}, and the reason passed to `end`
   */
  async request(message: Request, transfer: ArrayBuffer[], progress: ProgressListener): Promise<Answer> {
    const port = this.#started();
    try {
      port.post(message, transfer);
    } catch (cause) {
      throw new Unsendable("a message that cannot be sent", { cause });
    }
    port.hold(true);
    try {
      return await new Promise<Answer>((resolve, reject) => {
        this.#pending = { resolve, reject, progress };
      });
    } finally {
      this.#pending = undefined;
      port.hold(false);
    }
  }

  /** Whether the worker holds this mesh. */
  hasMesh(id: number): boolean {
    return this.#port !== undefined && this.#meshes.has(id);
  }

  /** Records that the worker holds this mesh, after it answered a job with it. */
  addMesh(id: number): void {
    this.#meshes.add(id);
  }

  /** Frees this mesh in the worker. */
  dropMesh(id: number): void {
    if (this.hasMesh(id)) this.#port?.post({ type: "drop-mesh", id });
    this.#meshes.delete(id);
  }

  /** Terminates the worker and its job. The next request starts another worker. */
  end(reason: unknown): void {
    const port = this.#port;
    this.#port = undefined;
    port?.terminate();
    this.#pending?.reject(reason);
  }

  #started(): Port {
    try {
      return this.start();
    } catch (error) {
      throw new WorkerLost(error instanceof Error ? error.message : String(error), { cause: error });
    }
  }

  #receive(message: Reply, port: Port): void {
    if (message.type === "progress") {
      try {
        this.#pending?.progress.report(message.stage, message.fraction, message.best);
      } catch (error) {
        this.end(error);
      }
    } else if (message.type === "needs-formats") {
      this.#sendFormats(port).catch((error) => this.end(error));
    } else if (message.error === undefined) {
      this.#pending?.resolve(message);
    } else if (message.error.code === "INTERNAL") {
      // After a trap, the state of the module is unknown, and its memory may be exhausted.
      this.end(new WorkerLost(message.error.found));
    } else {
      this.#pending?.reject(new JobFailed(message.error, message.data));
    }
  }

  async #sendFormats(port: Port): Promise<void> {
    const formats = await this.#setup.formats().catch((error) => {
      if (error instanceof Sim3AlignError) return partsOf(error);
      throw error;
    });
    port.post({ type: "formats", formats });
  }
}
