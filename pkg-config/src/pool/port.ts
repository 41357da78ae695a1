/** One interface for browser workers and Node worker threads. */

import type { CreateWorker, NodeWorkerLike, WebWorkerLike, WorkerLike } from "../types/platform.js";
import { failure, messageOf } from "../values/error.js";
import { oncePerKey } from "../values/validation.js";
import type { ToWorker } from "./messages.js";

/** The pool's end of the connection to a worker. */
export interface Port {
  post(message: ToWorker, transfer?: Transferable[]): void;
  /** Sets whether the worker keeps the process alive: while it is busy. */
  keepAlive(isBusy: boolean): void;
  terminate(): void;
}

/** The events of a worker. */
export interface PortEvents {
  onMessage(message: unknown): void;
  /** The worker terminated or failed to start. */
  onFailure(description: string): void;
}

/** Connects to a worker. */
export function portOf(worker: WorkerLike, { onMessage, onFailure }: PortEvents): Port {
  const node = "on" in worker ? (worker as NodeWorkerLike) : undefined;
  const unreadable = () => onFailure("a message that could not be read");
  if (node !== undefined) {
    node.on("message", onMessage);
    node.on("error", (error) => onFailure(messageOf(error)));
    node.on("messageerror", unreadable);
    node.on("exit", (code) => onFailure(`termination with exit code ${code}`));
    node.unref?.();
  } else {
    const web = worker as WebWorkerLike;
    web.addEventListener("message", ({ data }) => onMessage(data));
    web.addEventListener("error", (event) => {
      // Otherwise, error handlers of the page would report it as unhandled.
      event.preventDefault?.();
      onFailure(event.message || "a script that could not be loaded");
    });
    web.addEventListener("messageerror", unreadable);
  }
  return {
    post: (message, transfer = []) => worker.postMessage(message, transfer as ArrayBuffer[]),
    keepAlive: (isBusy) => (isBusy ? node?.ref?.() : node?.unref?.()),
    terminate: () => void worker.terminate(),
  };
}

/** Creates workers in this environment. */
export interface WorkerFactory {
  create: CreateWorker;
  /** The number of logical cores. */
  cores: number;
}

/**
 * Returns the factory for this environment, based on `Worker` or `node:worker_threads`.
 * @param script the source of the worker script, if it is not in a file
 * @param createWorker the caller's function that creates a worker
 */
export async function workerFactory(script?: string, createWorker?: CreateWorker): Promise<WorkerFactory> {
  const cores = globalThis.navigator?.hardwareConcurrency ?? (await coresOfNode());
  if (typeof Worker === "function" || createWorker !== undefined) {
    return { create: createWorker ?? (script === undefined ? fromFile : fromScript(script)), cores };
  }
  try {
    const { Worker: Thread }: typeof import("node:worker_threads") = await nodeModule("node:worker_threads");
    return {
      create: () => (script === undefined ? new Thread(scriptUrl()) : new Thread(script, { eval: true })),
      cores,
    };
  } catch (cause) {
    const remedy = "Omit workers: calls then run on the calling thread.";
    const expected = "Worker, or node:worker_threads";
    throw failure("WORKER_FAILED", "workers", "an environment without workers", expected, remedy, cause);
  }
}

/** The number of cores in Node, whose versions before 21 have no `navigator`. */
const coresOfNode = (): Promise<number> =>
  nodeModule("node:os").then(
    ({ availableParallelism }: typeof import("node:os")) => availableParallelism(),
    () => 2,
  );

/** The script as a file of the package: bundlers do not recognise this form. */
const scriptUrl = () => new URL("../worker.js", String(import.meta.url));

/** Bundlers recognise only this form. */
const fromFile = () =>
  startedFromAnywhere(() => new Worker(new URL("../worker.js", import.meta.url), { type: "module" }), scriptUrl);

function fromScript(script: string): CreateWorker {
  // One object URL for all workers, never revoked, because browsers do not report when they have read it.
  let url: string | undefined;
  return () => {
    url ??= URL.createObjectURL(new Blob([script], { type: "text/javascript" }));
    // In a sandboxed frame, module workers cannot load their script, because the origin is opaque. Deno only has module
    // workers.
    return new Worker(url, { type: "Deno" in globalThis ? "module" : "classic" });
  };
}

/** Imports a Node module. The name is in a variable, so that browser bundlers do not resolve it. */
const nodeModule = (name: string) => import(/* webpackIgnore: true */ /* @vite-ignore */ name);

/** For workers whose script is on another origin, such as that of a CDN: the address of a script that imports the one at an address: the browser would keep another one for each worker. */
const importing = oncePerKey((address: string) =>
  URL.createObjectURL(new Blob([`import ${JSON.stringify(address)};`], { type: "text/javascript" })),
);

/**
 * Starts a worker. Browsers start workers from their own origin only, but these may import from elsewhere.
 * @param start starts it directly
 * @param script the address of its script
 * @param name its name, if the script depends on it
 */
export function startedFromAnywhere(start: () => Worker, script: () => URL, name = ""): Worker {
  const { href, origin, protocol } = script();
  if (!protocol.startsWith("http") || origin === globalThis.location?.origin) return start();
  return new Worker(importing(href), { type: "module", name });
}
