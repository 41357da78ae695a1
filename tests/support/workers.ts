/** Workers that the tests can reach, and inputs that take a while. */
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { Worker } from "node:worker_threads";
import type { AlignInput, Alignment } from "sim3align";
import { installDir } from "./environment.js";
import { blob, render, truth } from "./scene.js";

/** The installed package's script for workers. */
export const workerUrl = pathToFileURL(join(installDir, "node_modules", "sim3align", "worker.js"));

/** Makes workers, and remembers them. */
export class Workers {
  readonly made: Worker[] = [];

  readonly create = (): Worker => {
    const worker = new Worker(workerUrl);
    this.made.push(worker);
    return worker;
  };
}

/** Decides how a worker's n-th answer, counted from 1, arrives. */
export function atAnswer(worker: Worker, n: number, act: (deliver: () => void) => void): void {
  const emit = worker.emit.bind(worker) as (...event: unknown[]) => boolean;
  let count = 0;
  worker.emit = ((...event: unknown[]) => {
    const [name, message] = event as [string, { type?: string }];
    if (name !== "message" || message.type !== "result" || ++count !== n) return emit(...event);
    act(() => emit(...event));
    return true;
  }) as typeof worker.emit;
}

/** A result without what differs from run to run. */
export { withoutTimes } from "./results.js";

const mesh = blob(60, 90);

/** An input for which `quality: "best"` takes a second or more. */
export const slowInput: AlignInput = {
  ...render(mesh, truth, { fx: 600, fy: 602, cx: 159.5, cy: 120 }, 320, 240),
  mesh,
};

/** Long enough for a worker to be at it. */
export const underWay = () => new Promise((resolve) => setTimeout(resolve, 150));
