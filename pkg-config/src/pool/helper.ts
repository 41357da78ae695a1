/** In a worker: helps another worker with its job. */
import type { Helper } from "../core.js";
import { beginHelp, type Modules, type Offer } from "../jobs.js";
import type { CoreMesh } from "../prepared-mesh.js";
import { turn } from "./turn.js";

/** About how long a helper runs tasks until it sends their results, milliseconds. */
const SLICE_MS = 3;

/** Numbers of the message that says that a helper is ready. */
const READY = 3;

/** Runs tasks of a job of another worker, until it is told to stop. */
export class HelpingWorker {
  readonly #port: MessagePort;
  readonly #mesh: CoreMesh | undefined;
  readonly #inbox: unknown[] = [];
  #isOver = false;
  #wake = () => {};

  /**
   * @param port the connection to the other worker, which first sends the input of its job
   * @param mesh the mesh of the input, if that has been prepared
   */
  constructor(port: MessagePort, mesh: CoreMesh | undefined) {
    this.#port = port;
    this.#mesh = mesh;
    port.onmessage = ({ data }) => {
      this.#inbox.push(data);
      this.#wake();
    };
  }

  stop(): void {
    this.#isOver = true;
    this.#wake();
  }

  async run(modules: Modules): Promise<void> {
    try {
      const offer = (await this.#next()) as Offer | undefined;
      if (offer === undefined) return;
      const { module, helper } = await beginHelp(offer, this.#mesh, modules);
      const { instance } = module;
      this.#port.postMessage(new Float64Array(READY));
      try {
        await this.#work(<T>(work: (helper: Helper) => T) => module.call(() => work(helper)));
      } finally {
        if (module.instance === instance) helper.free();
        module.drop(helper);
      }
    } finally {
      this.#port.close();
    }
  }

  async #work(call: <T>(work: (helper: Helper) => T) => T): Promise<void> {
    for (let message = await this.#next(); message !== undefined; message = await this.#next()) {
      const part = message as Float64Array;
      call((helper) => helper.receive(part));
      // A later message replaces the part.
      while (this.#inbox.length === 0 && !this.#isOver) {
        const results = call((helper) => helper.step(SLICE_MS));
        if (results === undefined) break;
        this.#port.postMessage(results, [results.buffer]);
        await turn();
      }
    }
  }

  /** The next message; `undefined` when it is time to stop. */
  async #next(): Promise<unknown> {
    while (this.#inbox.length === 0 && !this.#isOver) {
      await new Promise<void>((resolve) => {
        this.#wake = resolve;
      });
    }
    return this.#isOver ? undefined : this.#inbox.shift();
  }
}
