/** Workers that the tests can reach, and inputs that take a while. */
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { Worker } from "node:worker_threads";
import type { AlignInput } from "sim3align";
import { installDir } from "./environment.js";
import { blob, render, truth } from "./scene.js";

/** The installed package's script for workers. */
const workerUrl = pathToFileURL(join(installDir, "node_modules", "sim3align", "worker.js"));

/** A worker, and promises of what it does. */
export interface WatchedWorker extends Worker {
  /** Resolves when its job reports progress for the first time; the call needs an `onProgress`. */
  readonly isBusy: Promise<void>;
  /** Resolves when it has ended; keeps the process alive until then. */
  ended(): Promise<void>;
}

/** Makes workers, and remembers them. */
export class Workers {
  readonly made: WatchedWorker[] = [];
  readonly #awaited: (() => void)[] = [];

  readonly create = (): WatchedWorker => {
    const worker = new Worker(workerUrl);
    const isBusy = new Promise<void>((resolve) => {
      worker.on("message", ({ type }: { type: string }) => type === "progress" && resolve());
    });
    const hasEnded = new Promise<void>((resolve) => worker.once("exit", () => resolve()));
    const ended = () => {
      worker.ref();
      return hasEnded;
    };
    const watched = Object.assign(worker, { isBusy, ended });
    this.made.push(watched);
    for (const wake of this.#awaited.splice(0)) wake();
    return watched;
  };

  /** The n-th worker, counted from 0, once it has been made. */
  async nth(n: number): Promise<WatchedWorker> {
    for (;;) {
      const worker = this.made[n];
      if (worker !== undefined) return worker;
      await new Promise<void>((resolve) => this.#awaited.push(resolve));
    }
  }
}

/** A promise that is resolved from outside. */
export class Gate {
  open = () => {};
  readonly opened = new Promise<void>((resolve) => {
    this.open = resolve;
  });
}

const mesh = blob(60, 90);

/** An input that keeps `quality: "best"` busy long after its first report of progress. */
export const slowInput: AlignInput = {
  ...render(mesh, truth, { fx: 600, fy: 602, cx: 159.5, cy: 120 }, 320, 240),
  mesh,
};
