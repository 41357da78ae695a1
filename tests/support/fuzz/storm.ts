/** Storms of a pool: calls, aborts, disposals, moved arrays and lost workers in every order. */
import assert from "node:assert/strict";
import { type Aligner, createAligner, type PreparedMesh } from "sim3align";
import type { Random } from "../random.js";
import { blob, truth } from "../scene.js";
import { Workers } from "../workers.js";
import { checkError, type Outcome, outcomeOf, randomCall } from "./calls.js";
import { detach, pick, Thrown } from "./odd-values.js";
import { randomPicture } from "./pictures.js";

type Fields = Record<string, unknown>;

/** One storm: an aligner, what is done with it in a row, and what every call came to. */
export async function storm(random: Random): Promise<number> {
  const workers = new Workers();
  const size = random.whole(1, 3);
  const aligner = await createAligner({ workers: size, createWorker: workers.create });
  const state = new Storm(aligner, workers, random);
  for (let i = random.whole(3, 25); i > 0; i--) await state.act();
  await state.end();
  return state.count;
}

class Storm {
  readonly #aligner: Aligner;
  readonly #workers: Workers;
  readonly #random: Random;
  readonly #outcomes: Promise<Outcome>[] = [];
  readonly #reasons: unknown[] = [];
  readonly #controllers: AbortController[] = [];
  readonly #inputs: Fields[] = [];
  readonly #meshes: PreparedMesh[] = [];

  constructor(aligner: Aligner, workers: Workers, random: Random) {
    this.#aligner = aligner;
    this.#workers = workers;
    this.#random = random;
  }

  get count(): number {
    return this.#outcomes.length;
  }

  /** Does one of the things that callers do, and lets some time pass, or none. */
  async act(): Promise<void> {
    const random = this.#random;
    const acts: (() => unknown)[] = [
      () => this.#align(),
      () => this.#align(),
      () => this.#align(),
      () => this.#call(randomCall(this.#aligner, random, ["WORKER_FAILED"])),
      () => this.#call(() => this.#aligner.evaluate(this.#input() as never, truth, { ...this.#callOptions() })),
      () => this.#prepare(),
      () => this.#meshes.length > 0 && pick(random, this.#meshes).dispose(),
      () => this.#controllers.length > 0 && this.#abort(pick(random, this.#controllers)),
      () => this.#inputs.length > 0 && Object.values(pick(random, this.#inputs)).forEach(detachArray),
      () => this.#loop(),
      () => void pick(random, this.#workers.made).terminate(),
      () => random.between(0, 1) < 0.1 && this.#aligner.dispose(),
    ];
    pick(random, acts)();
    const waits = [
      () => {},
      () => {},
      () => Promise.resolve(),
      () => new Promise((resolve) => setImmediate(resolve)),
      () => new Promise((resolve) => setTimeout(resolve, random.whole(0, 8))),
    ];
    await pick(random, waits)();
  }

  /** Waits for all calls, and checks that the aligner still works, unless it was disposed. */
  async end(): Promise<void> {
    for (const outcome of await Promise.all(this.#outcomes)) {
      if ("error" in outcome) checkError(outcome.error, this.#reasons, ["WORKER_FAILED"]);
    }
    const input = randomPicture(this.#random);
    const last = await outcomeOf(() => this.#aligner.evaluate(input as never, truth));
    // A worker that was killed just now may be the one that gets the job, once.
    if ("error" in last) checkError(last.error, [], ["WORKER_FAILED"]);
    this.#aligner.dispose();
    const after = await outcomeOf(() => this.#aligner.evaluate(input as never, truth));
    assert.ok("error" in after && (after.error as { code?: string }).code === "DISPOSED", "a disposed aligner works");
    await Promise.all(this.#workers.made.map((worker) => worker.ended()));
  }

  #call(call: () => unknown): void {
    this.#outcomes.push(outcomeOf(call));
  }

  #align(): void {
    const [input, options] = [this.#input(), this.#callOptions()];
    this.#call(() => this.#aligner.align(input as never, { quality: "fast", ...options }));
  }

  #prepare(): void {
    this.#call(async () => {
      this.#meshes.push(await this.#aligner.prepareMesh(blob(5, 6), this.#signal()));
    });
  }

  /** A loop over several inputs, which may be left early. */
  #loop(): void {
    const inputs = Array.from({ length: this.#random.whole(1, 5) }, () => this.#input() as never);
    const last = this.#random.whole(0, 5);
    const ordered = this.#random.between(0, 1) < 0.5;
    this.#call(async () => {
      const results = this.#aligner.alignAll(inputs, { quality: "fast", ordered, ...this.#signal() });
      for await (const { index, error } of results) {
        if (error !== undefined) checkError(error, this.#reasons, ["WORKER_FAILED"]);
        if (index === last) break;
      }
    });
  }

  /** A new input, or one that another call has: its arrays may be moved at any time. */
  #input(): Fields {
    const random = this.#random;
    if (this.#inputs.length > 0 && random.between(0, 1) < 0.3) return pick(random, this.#inputs);
    const input = randomPicture(random);
    if (this.#meshes.length > 0 && random.between(0, 1) < 0.5) input.mesh = pick(random, this.#meshes);
    this.#inputs.push(input);
    return input;
  }

  #signal(): { signal?: AbortSignal } {
    if (this.#random.between(0, 1) < 0.5) return {};
    const controller = new AbortController();
    this.#controllers.push(controller);
    return { signal: controller.signal };
  }

  #callOptions(): object {
    const random = this.#random;
    const transfer = random.between(0, 1) < 0.4;
    return { transfer, ...this.#signal(), ...(random.between(0, 1) < 0.2 ? { onProgress: this.#onProgress() } : {}) };
  }

  /** A listener that ends its call in one of several ways, or does nothing. */
  #onProgress(): (() => unknown) | undefined {
    const listeners = [
      () => {},
      () => new Promise(() => {}),
      async () => Promise.reject(new Thrown("of an async function")),
      () => {
        throw new Thrown("of a listener");
      },
      () => this.#controllers.length > 0 && this.#abort(pick(this.#random, this.#controllers)),
      () => this.#random.between(0, 1) < 0.1 && this.#aligner.dispose(),
      () => void pick(this.#random, this.#workers.made).terminate(),
    ];
    return pick(this.#random, listeners);
  }

  #abort(controller: AbortController): void {
    const reason = new Thrown("of a signal");
    this.#reasons.push(reason);
    controller.abort(reason);
  }
}

const detachArray = (value: unknown) => ArrayBuffer.isView(value) && detach(value);
