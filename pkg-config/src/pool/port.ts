/** Workers of browsers and of Node, behind one face. */
import { Sim3AlignError } from "../error.js";
import type { Reply, Request } from "./protocol.js";

/** A worker: a `Worker` of browsers, Deno and Bun, or one of Node's `worker_threads`. */
export interface WorkerLike {
  postMessage(message: unknown, transfer: ArrayBuffer[]): void;
  terminate(): unknown;
}

type NodeWorker = import("node:worker_threads").Worker;

/** Makes a worker that runs this package's `worker.js`. */
export type CreateWorker = () => WorkerLike;

/** A worker as the pool sees it. */
export interface Port {
  post(message: Request, transfer?: ArrayBuffer[]): void;
  /** Whether the process stays alive for it. */
  hold(isHeld: boolean): void;
  terminate(): void;
}

/** What a worker tells the pool. */
export interface Ears {
  onMessage(message: Reply): void;
  /** It has ended, or never began. */
  onFailure(description: string): void;
}

/** Listens to a worker. */
export function portOf(worker: WorkerLike, ears: Ears): Port {
  return "on" in worker ? portOfNode(worker as NodeWorker, ears) : portOfWeb(worker as Worker, ears);
}

function portOfNode(worker: NodeWorker, { onMessage, onFailure }: Ears): Port {
  worker.on("message", onMessage);
  worker.on("error", (error: Error) => onFailure(`${error.name}: ${error.message}`));
  worker.on("messageerror", () => onFailure("a message that could not be read"));
  worker.on("exit", (code) => onFailure(`an end with exit code ${code}`));
  worker.unref();
  return {
    post: (message, transfer = []) => worker.postMessage(message, transfer),
    hold: (isHeld) => (isHeld ? worker.ref() : worker.unref()),
    terminate: () => void worker.terminate(),
  };
}

function portOfWeb(worker: Worker, { onMessage, onFailure }: Ears): Port {
  worker.addEventListener("message", ({ data }) => onMessage(data));
  worker.addEventListener("error", (event) => {
    // Else it goes on to the page's own error handlers, as if nobody had seen it.
    event.preventDefault();
    onFailure(event.message || "a script that could not be loaded");
  });
  worker.addEventListener("messageerror", () => onFailure("a message that could not be read"));
  return {
    post: (message, transfer = []) => worker.postMessage(message, transfer),
    hold: () => {},
    terminate: () => worker.terminate(),
  };
}

/** What makes workers here by itself, and how many run side by side. */
export interface Workshop {
  create: CreateWorker;
  cores: number;
}

/**
 * What this environment has: `Worker`, or Node's module.
 * @param script of the worker, where it is not in a file
 * @param createWorker the caller's way to make one
 */
export async function workshop(script?: string, createWorker?: CreateWorker): Promise<Workshop> {
  if (typeof Worker === "function" || createWorker !== undefined) {
    const cores = globalThis.navigator?.hardwareConcurrency ?? 2;
    return { create: createWorker ?? (script === undefined ? fromFile : fromScript(script)), cores };
  }
  try {
    const [threads, os] = await Promise.all([nodeModule("node:worker_threads"), nodeModule("node:os")]);
    const { Worker: Thread } = threads as typeof import("node:worker_threads");
    const url = () => new URL(/* webpackIgnore: true */ /* @vite-ignore */ "../worker.js", import.meta.url);
    return {
      create: () => (script === undefined ? new Thread(url()) : new Thread(script, { eval: true })),
      cores: (os as typeof import("node:os")).availableParallelism(),
    };
  } catch (cause) {
    throw new Sim3AlignError(
      {
        code: "WORKER_FAILED",
        argument: "workers",
        found: "an environment without workers",
        expected: "Worker, or node:worker_threads",
        remedy: "Leave workers out: the calls then run on this thread.",
      },
      { cause },
    );
  }
}

/** Bundlers know this form, and no other. */
const fromFile = () => new Worker(new URL("../worker.js", import.meta.url), { type: "module" });

function fromScript(script: string): CreateWorker {
  // One address for all, for as long as the page lives: when a browser has read it, it does not say.
  let url: string | undefined;
  return () => {
    url ??= URL.createObjectURL(new Blob([script], { type: "text/javascript" }));
    // In a sandboxed frame module workers have no origin that could load their script; Deno has no other workers.
    return new Worker(url, { type: "Deno" in globalThis ? "module" : "classic" });
  };
}

/** A module of Node's, by a name that bundlers for browsers don't follow: they never come here. */
const nodeModule = (name: string) => import(/* webpackIgnore: true */ /* @vite-ignore */ name);
