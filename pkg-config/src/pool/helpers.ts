/** In a worker: the other workers that help it with its job. */
import type { CoreHelpers } from "../core.js";
import type { Offer, Slices } from "../jobs.js";
import { turn } from "./turn.js";

/** About how long a job that has asked for help runs until it hears what has arrived, milliseconds. */
const SLICE_MS = 8;

/** The helpers of a job, between whose slices their messages arrive. */
export class Helpers implements CoreHelpers, Slices {
  readonly #needsHelp: () => void;
  readonly #ports: MessagePort[] = [];
  readonly #inbox: Float64Array[] = [];
  #offer: Offer | undefined;
  #isAsked = false;
  #isWaiting = false;
  #wake = () => {};

  /** @param needsHelp asks the pool for helpers */
  constructor(needsHelp: () => void) {
    this.#needsHelp = needsHelp;
  }

  get sliceMs(): number {
    return this.#isAsked ? SLICE_MS : Number.POSITIVE_INFINITY;
  }

  check(): void {}

  async turn(): Promise<void> {
    if (this.#isWaiting && this.#inbox.length === 0) {
      await new Promise<void>((resolve) => {
        this.#wake = resolve;
      });
    } else await turn();
    this.#isWaiting = false;
  }

  helpersFor(offer: Offer): this {
    this.#offer = offer;
    return this;
  }

  /** A worker that helps from now on. */
  add(port: MessagePort): void {
    const helper = this.#ports.push(port) - 1;
    port.onmessage = ({ data }) => {
      data[0] = helper;
      this.#hear(data);
    };
    port.postMessage(this.#offer);
  }

  /** A worker that no longer helps. */
  remove(helper: number): void {
    this.#ports[helper]?.close();
    this.#hear(Float64Array.of(helper));
  }

  /** Ends all connections. */
  close(): void {
    for (const port of this.#ports) port.close();
  }

  ask(): void {
    if (!this.#isAsked) this.#needsHelp();
    this.#isAsked = true;
  }

  send(helper: number, message: Float64Array<ArrayBuffer>): void {
    this.#ports[helper]?.postMessage(message, [message.buffer]);
  }

  receive(): Float64Array | undefined {
    return this.#inbox.shift();
  }

  wait(): void {
    this.#isWaiting = true;
  }

  #hear(message: Float64Array): void {
    this.#inbox.push(message);
    this.#wake();
  }
}
