/** Workers of browsers and of Node, behind one interface. */
import { Sim3AlignError } from "../error.js";
import type { CreateWorker, WorkerLike } from "../platform.js";
import type { Reply, Request } from "./protocol.js";

type NodeWorker = import("node:worker_threads").Worker;

/** The pool's end of the connection to a worker. */
export interface Port {
  post(message: Request, transfer?: ArrayBuffer[]): void;
  /** Whether the process stays alive for the worker. */
  hold(isHeld: boolean): void;
  terminate(): void;
}

/** The events of a worker. */
export interface PortEvents {
  onMessage(message: Reply): void;
  /** The worker has ended, or could not start. */
  onFailure(description: string): void;
}

/** Connects to a worker. */
export function portOf(worker: WorkerLike, events: PortEvents): Port {
  return "on" in worker ? portOfNode(worker as NodeWorker, events) : portOfWeb(worker as Worker, events);
}

function portOfNode(worker: NodeWorker, { onMessage, onFailure }: PortEvents): Port {
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

function portOfWeb(worker: Worker, { onMessage, onFailure }: PortEvents): Port {
  worker.addEventListener("message", ({ data }) => onMessage(data));
  worker.addEventListener("error", (event) => {
    // Otherwise the page's own error handlers would report it as unhandled.
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

/** Makes workers in this environment. */
export interface WorkerFactory {
  create: CreateWorker;
  /** How many threads the machine runs at the same time. */
  cores: number;
}

/**
 * The factory for this environment, which has `Worker` or `node:worker_threads`.
 * @param script the source of the worker's script, where it is not in a file
 * @param createWorker the caller's own way to make a worker
 */
export async function workerFactory(script?: string, createWorker?: CreateWorker): Promise<WorkerFactory> {
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

/** Bundlers know this form of a worker, and no other. */
const fromFile = () => new Worker(new URL("../worker.js", import.meta.url), { type: "module" });

function fromScript(script: string): CreateWorker {
  // One address for all workers, never revoked: browsers do not say when they have read it.
  let url: string | undefined;
  return () => {
    url ??= URL.createObjectURL(new Blob([script], { type: "text/javascript" }));
    // In a sandboxed frame module workers have no origin that could load their script; Deno has no other workers.
    return new Worker(url, { type: "Deno" in globalThis ? "module" : "classic" });
  };
}

/** A module of Node's. Bundlers for browsers do not follow a name in a variable; browsers never get here. */
const nodeModule = (name: string) => import(/* webpackIgnore: true */ /* @vite-ignore */ name);
