/**
 * `npm run bench:pool`: alignments a second by the number of workers, how much faster one hard case becomes, how long an
 * abort takes, what a lost worker costs, and the memory that a thousand alignments leave.
 */
import { availableParallelism } from "node:os";
import { join } from "node:path";
import { Worker } from "node:worker_threads";
import { buildPackage } from "../lib/package.mjs";
import { packageDir } from "../lib/paths.mjs";
import { step } from "../lib/step.mjs";
import { command, count } from "./command.mjs";
import { bumpyRing, foldersWith, packageModule, pictureOf, readTypedCase } from "./inputs.mjs";
import { fixed, markdownTable, median, quantile } from "./table.mjs";

/** The longest that an abort may take, milliseconds. */
const maxAbortMs = 100;

/** Objects of six sizes. */
const inputs = [
  ...[
    [2000, 320, 240],
    [20_000, 640, 480],
    [8000, 512, 512],
  ],
  ...[
    [60_000, 640, 480],
    [4000, 320, 240],
    [1000, 640, 480],
  ],
].map(([triangles = 0, width = 0, height = 0]) => pictureOf(bumpyRing(triangles), width, height));

/** @param {number} i */
const inputOf = (i) => /** @type {import("./inputs.mjs").TypedCase} */ (inputs[i % inputs.length]);

/** @param {number} cases */
function* cycle(cases) {
  for (let i = 0; i < cases; i++) yield inputOf(i);
}

/**
 * Milliseconds of an action.
 * @param {() => Promise<unknown>} action
 */
async function timed(action) {
  const began = performance.now();
  await action();
  return performance.now() - began;
}

/**
 * One row for each number of workers. They alternate, so that other load on the machine affects all.
 * @param {typeof import("../../pkg/index.js").createAligner} createAligner
 * @param {number} cases
 * @param {number} repeats
 */
async function measureThroughput(createAligner, cases, repeats) {
  const numbers = [0, 1, 2].filter((workers) => workers <= availableParallelism());
  const aligners = await Promise.all(numbers.map((workers) => createAligner({ workers })));
  /** @type {number[][]} */
  const times = numbers.map(() => []);
  for (let repeat = -1; repeat < repeats; repeat++) {
    for (const [i, aligner] of aligners.entries()) {
      const ms = await timed(async () => {
        for await (const { error } of aligner.alignAll(cycle(repeat < 0 ? inputs.length : cases)))
          if (error) throw error;
      });
      // The first round compiles.
      if (repeat >= 0) times[i]?.push(ms);
    }
  }
  for (const aligner of aligners) aligner.dispose();
  const middle = times.map(median);
  const rows = numbers.map((workers, i) => {
    const [own = Number.NaN, alone = Number.NaN] = [middle[i], middle[0]];
    return [workers, fixed(own / 1000, 2), fixed((1000 * cases) / own, 2), fixed(alone / own, 2)];
  });
  console.log(`\n${markdownTable([`alignAll, ${cases} inputs: workers`, "s", "alignments/s", "times"], rows)}\n`);
}

/**
 * The time of one hard case after the other, by the number of workers, which alternate: all share the search.
 * @param {typeof import("../../pkg/index.js").createAligner} createAligner
 * @param {number} repeats
 * @param {readonly string[]} folders
 */
async function measureHardCases(createAligner, repeats, folders) {
  const numbers = [0, 1, 2, 3, 4].filter((workers) => workers <= availableParallelism());
  const aligners = await Promise.all(numbers.map((workers) => createAligner({ workers })));
  const cases = [1, 2, 3].map((i) => ({ name: `ring ${i}`, input: inputOf(i) }));
  for (const folder of foldersWith("depth.npy", folders)) cases.push(await readTypedCase(folder));
  const rows = [];
  for (const { name, input } of cases) {
    /** @type {number[][]} */
    const times = numbers.map(() => []);
    for (let repeat = -1; repeat < repeats; repeat++) {
      for (const [i, aligner] of aligners.entries()) {
        const ms = await timed(() => aligner.align(input, { quality: "best" }));
        // The first round compiles.
        if (repeat >= 0) times[i]?.push(ms);
      }
    }
    const ratios = times.slice(1).map((own) => median(own.map((ms, k) => Number(times[0]?.[k]) / ms)));
    rows.push([name, fixed(median(times[0] ?? [])), ...ratios.map((ratio) => fixed(ratio, 2))]);
  }
  for (const aligner of aligners) aligner.dispose();
  const head = ["quality best", "without workers, ms", ...numbers.slice(1).map((workers) => `times with ${workers}`)];
  console.log(`\n${markdownTable(head, rows)}\n`);
}

/**
 * From the abort to the rejection, and to the end of the next alignment beyond what it takes anyway.
 * @param {typeof import("../../pkg/index.js").createAligner} createAligner
 * @param {number} aborts
 */
async function measureAborts(createAligner, aborts) {
  const aligner = await createAligner({ workers: 1 });
  const input = inputOf(1);
  /** @type {number[]} */
  const latencies = [];
  /** @type {number[]} */
  const next = [];
  for (let i = 0; i < aborts; i++) {
    const controller = new AbortController();
    const call = aligner.align(input, { quality: "best", signal: controller.signal });
    const outcome = call.then(
      () => 0,
      () => performance.now(),
    );
    // Anywhere in the first 300 ms.
    await new Promise((resolve) => setTimeout(resolve, (i * 37) % 300));
    const aborted = performance.now();
    controller.abort();
    const rejected = await outcome;
    if (rejected > 0) latencies.push(rejected - aborted);
    next.push(await timed(() => aligner.estimateSim3(cloud, cloud, pairs)));
  }
  aligner.dispose();
  const quantiles = [0.5, 0.9, 0.99, 1].map((share) => quantile(latencies, share));
  const rows = [[latencies.length, ...quantiles.map((ms) => fixed(ms, 1))]];
  console.log(`\n${markdownTable(["aborts", "median, ms", "90 %", "99 %", "longest"], rows)}`);
  console.log(`\nThe next call waits ${fixed(median(next), 1)} ms (median) for its new worker.\n`);
  return quantile(latencies, 1) <= maxAbortMs;
}

/**
 * Two alignments at once, undisturbed, and with one of their workers killed on the way: what that costs, and whether the
 * bits stay the same.
 * @param {typeof import("../../pkg/index.js").createAligner} createAligner
 * @param {number} losses
 */
async function measureLosses(createAligner, losses) {
  /** @type {Worker[]} */
  const made = [];
  const createWorker = () => {
    const worker = new Worker(join(packageDir, "worker.js"));
    made.push(worker);
    return worker;
  };
  const aligner = await createAligner({ workers: 2, createWorker });
  const matrices = async () => {
    const results = await Promise.all([1, 3].map((i) => aligner.align(inputOf(i))));
    return results.map(({ matrix }) => matrix.join()).join();
  };
  const expected = await matrices();
  /** @type {[number[], number[]]} */
  const times = [[], []];
  let replaced = 0;
  for (let i = 0; i < losses; i++) {
    times[0].push(await timed(matrices));
    const before = made.length;
    const ms = await timed(async () => {
      const found = matrices();
      // Anywhere in the first 200 ms.
      await new Promise((resolve) => setTimeout(resolve, (i * 37) % 200));
      await made.at(-1)?.terminate();
      if ((await found) !== expected) throw new Error("A lost worker changed the result.");
    });
    times[1].push(ms);
    replaced += made.length - before;
  }
  aligner.dispose();
  const rows = [[losses, replaced, ...times.map((ms) => fixed(median(ms)))]];
  const head = ["workers killed", "replaced", "two alignments undisturbed, ms", "with one worker killed, ms"];
  console.log(`\n${markdownTable(head, rows)}\n`);
}

const cloud = Float64Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1);
const pairs = Uint32Array.of(0, 0, 1, 1, 2, 2, 3, 3);

/**
 * The process's memory as alignments go by.
 * @param {typeof import("../../pkg/index.js").createAligner} createAligner
 * @param {number} alignments
 */
async function measureMemory(createAligner, alignments) {
  const aligner = await createAligner({ workers: 2 });
  const rows = [];
  let done = 0;
  for await (const { error } of aligner.alignAll(cycle(alignments), { quality: "fast" })) {
    if (error) throw error;
    done += 1;
    if ([50, alignments / 2, alignments].includes(done)) {
      rows.push([`after ${done}`, fixed(process.memoryUsage().rss / 1e6)]);
    }
  }
  aligner.dispose();
  console.log(`\n${markdownTable(["2 workers, fast", "resident memory of the process, MB"], rows)}\n`);
}

await command("bench:pool", (program) =>
  program
    .description("Measures workers: throughput, hard cases, aborts (fails beyond 100 ms), losses, memory.")
    .option("--hard <folders...>", "case folders that are aligned with the quality best, besides generated ones", [])
    .option("--cases <n>", "inputs of alignAll", count, 60)
    .option("--repeats <n>", "how often each is measured, in turn", count, 3)
    .option("--aborts <n>", "how many calls are aborted", count, 100)
    .option("--losses <n>", "how many workers are killed under their job", count, 20)
    .option("--alignments <n>", "how many the memory is watched over", count, 1000)
    .action(async ({ cases, repeats, hard, aborts, losses, alignments }) => {
      await buildPackage();
      const { createAligner } = await packageModule("index.js");
      await step("throughput", () => measureThroughput(createAligner, cases, repeats));
      await step("hard cases", () => measureHardCases(createAligner, repeats, hard));
      const isQuick = await step("aborts", () => measureAborts(createAligner, aborts));
      await step("lost workers", () => measureLosses(createAligner, losses));
      await step("memory", () => measureMemory(createAligner, alignments));
      if (!isQuick) {
        console.error(`An abort took longer than ${maxAbortMs} ms.`);
        process.exitCode = 1;
      }
    }),
);
