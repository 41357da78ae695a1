/** Alignments per second and the time of a hard case by the number of workers, and the duration of an abort. */
import { availableParallelism } from "node:os";
import { fixed, markdownTable, median, quantile } from "../bench/table.mjs";
import { bumpyRing, createAligner, pictureOf, readTypedCase } from "./inputs.mjs";

/** @param {() => Promise<unknown>} action */
async function timed(action) {
  const began = performance.now();
  await action();
  return performance.now() - began;
}

/**
 * Medians of an action on aligners with 0, 1 and 2 workers, which alternate, so that other load affects all.
 * @param {(aligner: any) => Promise<unknown>} action
 * @param {number} runs
 */
async function byWorkers(action, runs) {
  const numbers = [0, 1, 2].filter((workers) => workers <= availableParallelism());
  const aligners = await Promise.all(numbers.map((workers) => createAligner({ workers })));
  /** @type {number[][]} */
  const times = numbers.map(() => []);
  // The first round compiles.
  for (let run = -1; run < runs; run++) {
    for (const [i, aligner] of aligners.entries()) {
      const ms = await timed(() => action(aligner));
      if (run >= 0) times[i]?.push(ms);
    }
  }
  for (const aligner of aligners) aligner.dispose();
  return times.map(median);
}

/**
 * @param {readonly string[]} folders case folders for the hard case; a synthetic object without
 * @param {{ runs: number, quick: boolean }} options
 */
export async function measurePool(folders, { runs, quick }) {
  const shapes = [
    [500, 160],
    [2000, 320],
    [20_000, 640],
  ];
  const inputs = shapes.map(([triangles = 0, width = 0]) => pictureOf(bumpyRing(triangles), width, (3 * width) / 4));
  const count = quick ? 6 : 60;
  const many = Array.from({ length: count }, (_, i) => inputs[i % inputs.length]);
  const rate = await byWorkers(async (aligner) => {
    for await (const { error } of aligner.alignAll(many)) if (error !== undefined) throw error;
  }, runs);
  const rows = [[`alignments per second, ${count} inputs`, ...rate.map((ms) => fixed((1000 * count) / ms, 1))]];
  const hard =
    folders.length > 0 ? await Promise.all(folders.map(readTypedCase)) : [{ name: "ring", input: inputs[1] }];
  for (const { name, input } of hard) {
    const times = await byWorkers((aligner) => aligner.align(input, { quality: "best" }), runs);
    rows.push([`${name}, quality best, ms`, ...times.map((ms) => fixed(ms))]);
  }
  console.log(`\n${markdownTable(["workers", "0", "1", "2"].slice(0, rate.length + 1), rows)}`);
  await measureAborts(inputs[2], quick ? 5 : 100);
}

/** @param {object | undefined} input @param {number} count */
async function measureAborts(input, count) {
  const aligner = await createAligner({ workers: 1 });
  /** @type {number[]} */
  const latencies = [];
  for (let i = 0; i < count; i++) {
    const controller = new AbortController();
    const rejected = aligner.align(input, { quality: "best", signal: controller.signal }).then(
      () => NaN,
      () => performance.now(),
    );
    // Anywhere in the first 300 ms.
    await new Promise((resolve) => setTimeout(resolve, (i * 37) % 300));
    const aborted = performance.now();
    controller.abort();
    latencies.push((await rejected) - aborted);
  }
  aligner.dispose();
  const settled = latencies.filter((ms) => !Number.isNaN(ms));
  const row = [settled.length, fixed(median(settled), 1), fixed(quantile(settled, 1), 1)];
  console.log(`\n${markdownTable(["aborts of a worker's job", "median, ms", "longest, ms"], [row])}`);
}
