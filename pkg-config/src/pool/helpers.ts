/** Code of workers with a long job, and of workers that help with one. */
import { beginHelp, type Scheduler, type SearchHelp, type SharedSearch } from "../calls/context.js";
import type { CoreHelpers } from "../modules/exports.js";
import type { Modules } from "../modules/module.js";
import type { HelpJob } from "./messages.js";

/** About how long a job that has asked for help runs until it hears what has arrived, milliseconds. */
const SLICE_MS = 8;

/** About how long a helper runs tasks until it sends their results, milliseconds. */
const HELP_MS = 3;

/** The numbers of a ready message of a helper. */
const READY = 3;

/** The messages that have arrived. */
class Inbox<T> {
  readonly #messages: T[] = [];
  #wake = () => {};

  get isEmpty(): boolean {
    return this.#messages.length === 0;
  }

  put(message: T): void {
    this.#messages.push(message);
    this.#wake();
  }

  take(): T | undefined {
    return this.#messages.shift();
  }

  /** Waits until there is a message. */
  async filled(): Promise<void> {
    while (this.isEmpty) {
      await new Promise<void>((resolve) => {
        this.#wake = resolve;
      });
    }
  }
}

/** The helpers of a job, between whose slices their messages arrive. */
export class Helpers implements CoreHelpers, Scheduler {
  readonly #ports: MessagePort[] = [];
  readonly #inbox = new Inbox<Float64Array>();
  #search: SharedSearch | undefined;
  #isAsked = false;
  #isWaiting = false;

  /** @param askPool asks the pool for helpers */
  constructor(private readonly askPool: () => void) {}

  get sliceMs(): number {
    return this.#isAsked ? SLICE_MS : Number.POSITIVE_INFINITY;
  }

  check(): void {}

  async turn(): Promise<void> {
    await (this.#isWaiting && this.#inbox.isEmpty ? this.#inbox.filled() : turn());
    this.#isWaiting = false;
  }

  /** Only the first search of a job has helpers: those that have come hold its input, and may still send its results. */
  helpersFor(search: SharedSearch): this | undefined {
    if (this.#search !== undefined) return undefined;
    this.#search = search;
    return this;
  }

  /** A worker helps from now on; or, without a port, has left. */
  change(helper: number, port: MessagePort | undefined): void {
    if (port === undefined) {
      this.#ports[helper]?.close();
      this.#inbox.put(Float64Array.of(helper));
      return;
    }
    this.#ports[helper] = port;
    port.onmessage = ({ data }) => {
      data[0] = helper;
      this.#inbox.put(data);
    };
    port.postMessage(this.#search);
  }

  /** Ends all connections. */
  close(): void {
    for (const port of this.#ports) port?.close();
  }

  ask(): void {
    if (!this.#isAsked) this.askPool();
    this.#isAsked = true;
  }

  send(helper: number, message: Float64Array<ArrayBuffer>): void {
    this.#ports[helper]?.postMessage(message, [message.buffer]);
  }

  receive(): Float64Array | undefined {
    return this.#inbox.take();
  }

  wait(): void {
    this.#isWaiting = true;
  }
}

/** Helps another worker with its job, until a stop message. The first message is the search, the others its tasks. */
export class HelperSession {
  readonly #inbox = new Inbox<SharedSearch | Float64Array | "stop">();
  #isOver = false;

  constructor(private readonly data: HelpJob["data"]) {
    data.port.onmessage = ({ data }) => this.#inbox.put(data);
  }

  stop(): void {
    this.#isOver = true;
    this.#inbox.put("stop");
  }

  async run(modules: Modules): Promise<void> {
    const { port, mesh } = this.data;
    let help: SearchHelp | undefined;
    try {
      for (;;) {
        await this.#inbox.filled();
        const message = this.#inbox.take();
        if (this.#isOver || message === undefined || message === "stop") return;
        if (!(message instanceof Float64Array)) {
          help = await beginHelp(message, mesh, modules);
          port.postMessage(new Float64Array(READY));
        } else if (help !== undefined) await this.#runTasks(help, message);
      }
    } finally {
      help?.end();
      port.close();
    }
  }

  /** Runs tasks until there are no more, or other ones: a later message replaces these. */
  async #runTasks({ call }: SearchHelp, tasks: Float64Array): Promise<void> {
    call((helper) => helper.receive(tasks));
    while (this.#inbox.isEmpty) {
      const results = call((helper) => helper.step(HELP_MS));
      if (results === undefined) return;
      this.data.port.postMessage(results, [results.buffer]);
      await turn();
    }
  }
}

const waiting: (() => void)[] = [];
let ownPort: MessagePort | undefined;

/** Calls back when the messages that were sent to this thread have arrived: unlike a timer, not milliseconds later. */
function callLater(callback: () => void): void {
  // Node would handle a thousand messages of this port before those of another one.
  if (typeof setImmediate === "function") {
    setImmediate(callback);
    return;
  }
  if (ownPort === undefined) {
    const { port1, port2 } = new MessageChannel();
    port1.onmessage = () => waiting.shift()?.();
    ownPort = port2;
  }
  waiting.push(callback);
  ownPort.postMessage(undefined);
}

/** Waits until messages have arrived. */
const turn = () => new Promise<void>(callLater);
