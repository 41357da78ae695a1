/**
 * Calls side by side without workers: they wait for one another, pause, are aborted, and lose their aligner. Each settles,
 * and those that end have the bits of the call alone, whatever becomes of the others.
 */
import assert from "node:assert/strict";
import { type Aligner, createAligner } from "sim3align";
import type { Random } from "../random.js";
import { withoutTimes } from "../results.js";
import { columnMajor, input, truth } from "../scene.js";
import { checkError, type Outcome, outcomeOf } from "./calls.js";
import { pick, Thrown } from "./odd-values.js";

/** Points on a bumpy surface; several times the size, turned and moved. */
const source = Float64Array.from({ length: 1200 }, (_, i) => bumpy(Math.floor(i / 3))[i % 3] as number);
const target = Float64Array.from({ length: 1200 }, (_, i) => {
  const [x, y, z] = bumpy(Math.floor(i / 3));
  return [3 - 2 * y, 1 + 2 * x, 2 * z][i % 3] as number;
});
const pairs = Uint32Array.from({ length: 800 }, (_, i) => (i % 4 === 1 ? (7 * i) % 400 : Math.floor(i / 2)));

function bumpy(i: number): [x: number, y: number, z: number] {
  const [height, angle] = [(2 * i + 1) / 400 - 1, 2.4 * i];
  const radius = Math.sqrt(1 - height * height) * (1 + 0.3 * Math.sin(3 * angle) + 0.2 * height);
  return [radius * Math.cos(angle), 0.8 * radius * Math.sin(angle), 0.6 * height];
}

type Signal = { signal?: AbortSignal };

/** The calls. Each leaves its arguments as they are. */
const calls: readonly ((aligner: Aligner, own: Signal) => Promise<unknown>)[] = [
  async (aligner, own) => withoutTimes(await aligner.align(input, { quality: "fast", ...own })),
  async (aligner, own) => withoutTimes(await aligner.align(input, { preset: "paper", ransacIterations: 200, ...own })),
  async (aligner, own) => withoutTimes(await aligner.register(source, target, own)),
  async (aligner, own) => withoutTimes(await aligner.register(source, target, { scale: 2, ...own })),
  async (aligner, own) => withoutTimes(await aligner.register(target, source, { scale: [0.4, 0.6], seed: 5, ...own })),
  async (aligner, own) => withoutTimes(await aligner.register(source, target, { workBudget: 5, ...own })),
  async (aligner, own) => withoutTimes(await aligner.estimateSim3(source, target, pairs, own)),
  async (aligner, own) => withoutTimes(await aligner.estimateSim3(source, target, pairs, { scale: 2, ...own })),
  (aligner, own) => aligner.evaluate(input, Float64Array.from(columnMajor(truth)), own),
  (aligner, own) => aligner.register(source, new Float64Array(1200), own),
  (aligner, own) => aligner.estimateSim3(source, target, new Uint32Array(6), own),
];

/** What each call comes to alone. */
const alone: string[] = [];

/** Several calls of two aligners, some of which are aborted, and perhaps all of one by the end of that aligner. */
export async function sideBySide(random: Random): Promise<number> {
  const aligners = await Promise.all([createAligner(), createAligner()]);
  while (alone.length < calls.length) {
    alone.push(inWords(await outcomeOf(() => calls[alone.length]?.(aligners[0], {}))));
  }
  const clock = performance.now;
  let leaps = 0;
  // On this clock, time is over at a random share of the pause points.
  const share = random.between(0, 1);
  performance.now = () => {
    leaps += random.between(0, 1) < share ? 1000 : 0;
    return clock.call(performance) + leaps;
  };
  try {
    const running = Array.from({ length: random.whole(2, 6) }, () => begun(pick(random, aligners), random));
    const disposed = random.between(0, 1) < 0.3 ? pick(random, aligners) : undefined;
    if (disposed) later(random, () => disposed.dispose());
    for (const { aligner, index, outcome, reason } of await Promise.all(running)) {
      const words = inWords(outcome);
      if (words === alone[index]) continue;
      assert.ok("error" in outcome, `call ${index}: other bits than alone: ${words}, ${alone[index]}`);
      const { error } = outcome;
      if (reason !== undefined && error === reason) continue;
      checkError(error);
      assert.ok(aligner === disposed && (error as { code?: string }).code === "DISPOSED", `call ${index}: ${words}`);
    }
    return running.length;
  } finally {
    performance.now = clock;
    for (const aligner of aligners) aligner.dispose();
  }
}

/** A call, perhaps with a signal, and its outcome. */
async function begun(aligner: Aligner, random: Random) {
  const index = random.whole(0, calls.length - 1);
  const chance = random.between(0, 1);
  const controller = new AbortController();
  const reason = chance < 0.4 ? new Thrown("of a signal") : undefined;
  if (reason !== undefined) later(random, () => controller.abort(reason));
  const own = chance < 0.6 ? { signal: controller.signal } : {};
  return { aligner, index, reason, outcome: await outcomeOf(() => calls[index]?.(aligner, own)) };
}

/** Acts now, or after a number of turns of the thread. */
function later(random: Random, act: () => void): void {
  const turns = pick(random, [0, 1, 2, 5, 20, 100]);
  const turn = (left: number) => (left === 0 ? act() : void setTimeout(() => turn(left - 1)));
  turn(turns);
}

/** An outcome to the bit. */
const inWords = (outcome: Outcome) =>
  "result" in outcome ? JSON.stringify(outcome.result) : `${(outcome.error as Error).message}`;
