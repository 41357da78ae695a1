/** What runs in a worker: does the jobs that its aligner asks for, one after the other. */
import type { Core, Formats } from "./core.js";
import { internalError, partsOf, Sim3AlignError } from "./error.js";
import { resolveInput } from "./input/resolve.js";
import { type Job, perform, withoutInput } from "./jobs.js";
import { type Reply, type Request, SEARCHED, type ShareRequest } from "./pool/protocol.js";

import { alignmentOf, withWarnings } from "./results.js";
import { buffersOf } from "./transfer.js";
// As they are: a worker's script is one file to some bundlers, which leaves nothing to be loaded later.
import * as coreGlue from "./wasm/core.js";
import * as formatsGlue from "./wasm/formats.js";
import { type LoadedModule, WasmModule } from "./wasm-module.js";

type Post = (message: Reply, transfer?: ArrayBuffer[]) => void;

/** One worker's state. */
class Workplace {
  readonly #post: Post;
  #core: Promise<LoadedModule<Core>> | undefined;
  #formats: Promise<LoadedModule<Formats>> | undefined;
  #hearFormats: ((message: Request & { type: "formats" }) => void) | undefined;
  /** Of the input that is shared. */
  #warnings: string[] = [];

  constructor(post: Post) {
    this.#post = post;
  }

  async hear(message: Request): Promise<void> {
    if (message.type === "formats") return this.#hearFormats?.(message);
    if (message.type === "start") {
      const core = new WasmModule<Core>("core", message.core, () => coreGlue as unknown as Core).load();
      // Whoever needs it sees the failure.
      core.catch(() => {});
      this.#core = core;
      return;
    }
    const data = message.type === "job" && message.returnData ? message.job.data : undefined;
    try {
      const result = message.type === "job" ? await this.#perform(message) : await this.#step(message);
      this.#post({ type: "result", result, data }, [...buffersOf(data), ...foundIn(message, result)]);
    } catch (error) {
      const known = error instanceof Sim3AlignError ? error : internalError(error);
      this.#post({ type: "error", error: partsOf(known), data }, buffersOf(data));
    }
  }

  async #perform({ job, wantsProgress }: { job: Job; wantsProgress: boolean }): Promise<unknown> {
    return perform(job, await this.#tools(), this.#listener(wantsProgress));
  }

  /** A step of an alignment that several work on. */
  async #step(request: ShareRequest): Promise<unknown> {
    const { core, formats } = await this.#tools();
    switch (request.type) {
      case "share": {
        const { data, options } = request.job;
        const { core: input, warnings } = await resolveInput(data, formats);
        core.call((c) => c.beginShare(input, options), withoutInput);
        this.#warnings = warnings;
        return null;
      }
      case "step":
        return core.call((c) => c.stepShare(request.found, request.part, request.parts));
      case "finish": {
        const listener = this.#listener(request.wantsProgress, SEARCHED);
        return withWarnings(alignmentOf(core.call((c) => c.finishShare(listener), withoutInput)), this.#warnings);
      }
    }
  }

  async #tools() {
    if (this.#core === undefined) throw new Error("no core");
    return { core: await this.#core, formats: () => this.#loadFormats() };
  }

  #loadFormats(): Promise<LoadedModule<Formats>> {
    if (this.#formats === undefined) {
      const loading = this.#askForFormats();
      this.#formats = loading;
      loading.catch(() => {
        this.#formats = undefined;
      });
    }
    return this.#formats;
  }

  async #askForFormats(): Promise<LoadedModule<Formats>> {
    const answer = await new Promise<Request & { type: "formats" }>((resolve) => {
      this.#hearFormats = resolve;
      this.#post({ type: "needs-formats" });
    });
    if ("error" in answer) throw new Sim3AlignError(answer.error);
    return new WasmModule<Formats>("formats", answer.module, () => formatsGlue).load();
  }

  /** Reports progress, where it is wanted; the first `done` of the whole is done already. */
  #listener(isWanted: boolean, done = 0) {
    if (!isWanted) return undefined;
    return (stage: (Reply & { type: "progress" })["stage"], fraction: number, best?: Float64Array) =>
      this.#post({ type: "progress", stage, fraction: done + (1 - done) * fraction, best });
  }
}

/** The large array in what came of a step, which is not needed here any more. */
const foundIn = ({ type }: Request, result: unknown): ArrayBuffer[] => (type === "step" ? buffersOf(result) : []);

/** The part of a browser's worker's global object that is used here; Node's has a module in its place. */
const scope = globalThis as unknown as { postMessage?: Post; onmessage?: (event: { data: Request }) => void };

if (typeof scope.postMessage === "function") {
  const workplace = new Workplace((message, transfer = []) => {
    (scope.postMessage as (message: Reply, transfer: ArrayBuffer[]) => void)(message, transfer);
  });
  scope.onmessage = ({ data }) => void workplace.hear(data);
} else {
  // A name that bundlers for browsers don't follow: they never come here. Messages wait until somebody listens.
  const name = "node:worker_threads";
  import(/* webpackIgnore: true */ /* @vite-ignore */ name).then(
    ({ parentPort }: typeof import("node:worker_threads")) => {
      const workplace = new Workplace((message, transfer = []) => parentPort?.postMessage(message, transfer));
      parentPort?.on("message", (message: Request) => void workplace.hear(message));
    },
  );
}
