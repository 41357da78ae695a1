/** A place for a worker, which is replaced when it fails. */
import { type ErrorParts, partsOf, Sim3AlignError } from "../error.js";
import type { ProgressListener } from "../progress.js";
import { type CreateWorker, type Port, portOf } from "./port.js";
import type { Reply, Request } from "./protocol.js";

/** The worker ended, or trapped: what it had been asked was not answered, and may be asked again. */
export class WorkerLost extends Error {}

/** The message can't be sent: something in it can't be cloned, or moved. */
export class Unsendable extends Error {}

/** A job that failed in a worker, with the data that came back. */
export class JobFailed {
  readonly error: Sim3AlignError;
  readonly data: unknown;

  constructor(parts: ErrorParts, data: unknown) {
    this.error = new Sim3AlignError(parts);
    this.data = data;
  }
}

/** What came of a request. */
export interface Answer {
  result: unknown;
  data?: unknown;
}

/** What a worker needs. */
export interface Supplies {
  create: CreateWorker;
  core: WebAssembly.Module;
  formats(): Promise<WebAssembly.Module>;
}

interface Pending {
  resolve(answer: Answer): void;
  reject(reason: unknown): void;
  progress: ProgressListener | undefined;
}

/** A place for a worker. */
export class WorkerSlot {
  readonly #supplies: Supplies;
  #port: Port | undefined;
  #pending: Pending | undefined;

  constructor(supplies: Supplies) {
    this.#supplies = supplies;
  }

  /** The worker that is here now: another object once it has been replaced. */
  get worker(): unknown {
    return this.#port;
  }

  /** Starts a worker where there is none. A failure shows at the next request. */
  start(): Port {
    if (this.#port !== undefined) return this.#port;
    // Messages of a worker that was replaced may still arrive.
    const ifCurrent = (act: () => void) => {
      if (this.#port === port) act();
    };
    const port = portOf(this.#supplies.create(), {
      onMessage: (message) => ifCurrent(() => this.#hear(message)),
      onFailure: (description) => ifCurrent(() => this.end(new WorkerLost(description))),
    });
    this.#port = port;
    port.post({ type: "start", core: this.#supplies.core });
    return port;
  }

  /**
   * Asks the worker for something; one thing at a time.
   * @throws {@link Unsendable}, {@link WorkerLost}, {@link JobFailed}, what `end` was given
   */
  async request(message: Request, transfer: ArrayBuffer[] = [], progress?: ProgressListener): Promise<Answer> {
    const port = this.#started();
    try {
      port.post(message, transfer);
    } catch (cause) {
      throw new Unsendable("a message that can't be sent", { cause });
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

  /** Ends the worker, and with it what it is doing. The next request starts another. */
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

  #hear(message: Reply): void {
    switch (message.type) {
      case "needs-formats":
        this.#sendFormats();
        break;
      case "progress":
        try {
          this.#pending?.progress?.report(message.stage, message.fraction, message.best);
        } catch (error) {
          this.end(error);
        }
        break;
      case "result":
        this.#pending?.resolve(message);
        break;
      case "error":
        // After a trap the module's state is unknown, and its memory may be used up.
        if (message.error.code === "INTERNAL") this.end(new WorkerLost(message.error.found));
        else this.#pending?.reject(new JobFailed(message.error, message.data));
    }
  }

  async #sendFormats(): Promise<void> {
    const port = this.#port;
    try {
      port?.post({ type: "formats", module: await this.#supplies.formats() });
    } catch (error) {
      if (error instanceof Sim3AlignError) port?.post({ type: "formats", error: partsOf(error) });
      else this.end(error);
    }
  }
}
