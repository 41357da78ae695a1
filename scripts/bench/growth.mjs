/**
 * `npm run bench:growth`: time, memory and longest block of one alignment as WebAssembly, without workers, by the number of
 * pixels and of triangles.
 */
import { loadavg } from "node:os";
import { buildPackage } from "../lib/package.mjs";
import { command, count } from "./command.mjs";
import { bumpyRing, freshCore, pictureOf } from "./inputs.mjs";
import { fixed, markdownTable, median } from "./table.mjs";

/** The sizes that grow, and the size of the other while they do. */
const pixels = [
  [160, 120],
  [320, 240],
  [640, 480],
  [1280, 960],
  [1920, 1440],
  [3840, 2160],
];
const triangles = [100, 1000, 10_000, 100_000, 500_000, 1_000_000];
const usual = { triangles: 20_000, width: 640, height: 480 };

/** The stages before the search, the search, and what follows it. */
const groups = {
  "before, ms": ["observe", "sample", "normals", "prepare"],
  "search, ms": ["search", "refine"],
  "metrics, ms": ["metrics"],
};

/**
 * Runs a call, and measures how long it keeps other work of the thread waiting.
 * @param {() => Promise<any>} call
 */
async function watched(call) {
  let [last, longest, isOver] = [performance.now(), 0, false];
  const look = () => {
    const now = performance.now();
    longest = Math.max(longest, now - last);
    last = now;
    if (!isOver) setImmediate(look);
  };
  setImmediate(look);
  const begun = performance.now();
  const result = await call();
  const ms = performance.now() - begun;
  isOver = true;
  look();
  return { result, ms, longest };
}

/**
 * @param {typeof usual} size
 * @param {number} runs
 */
async function measure({ triangles, width, height }, runs) {
  const input = pictureOf(bumpyRing(triangles), width, height, 1.6);
  const { aligner, memory } = await freshCore();
  /** @type {Awaited<ReturnType<typeof watched>>[]} */
  const results = [];
  for (let i = 0; i < runs; i++) results.push(await watched(() => aligner.align(input)));
  const stages = Object.values(groups).map((names) =>
    median(
      results.map(({ result }) => names.reduce((sum, name) => sum + (result.diagnostics.timingsMs[name] ?? 0), 0)),
    ),
  );
  return [
    `${width} × ${height}`,
    String(input.mesh.indices.length / 3),
    fixed(median(results.map(({ ms }) => ms))),
    ...stages.map((ms) => fixed(ms)),
    fixed(Math.max(...results.map(({ longest }) => longest))),
    fixed(memory.buffer.byteLength / 1e6),
    results[0]?.result.diagnostics.effort ?? "",
  ];
}

await command("bench:growth", (program) =>
  program
    .description("Times alignments by the number of pixels and of triangles.")
    .option("--runs <n>", "alignments of each size", count, 3)
    .action(async ({ runs }) => {
      await buildPackage();
      const head = ["pixels", "triangles", "ms", ...Object.keys(groups), "longest block, ms", "memory, MB", "effort"];
      const tables = [
        pixels.map(([width = 0, height = 0]) => ({ ...usual, width, height })),
        triangles.map((count) => ({ ...usual, triangles: count })),
        [{ triangles: 500_000, width: 3840, height: 2160 }],
      ];
      for (const sizes of tables) {
        const rows = [];
        for (const size of sizes) rows.push(await measure(size, runs));
        console.log(`\n${markdownTable(head, rows)}`);
      }
      console.log(`
Medians of ${runs} alignments with the default options, Node ${process.version}; the block and the memory are the largest.
Load of the machine: ${fixed(loadavg()[0], 1)}.`);
    }),
);
