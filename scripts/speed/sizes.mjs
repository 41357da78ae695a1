/** Time, longest block of the thread and memory of one alignment by the number of pixels and triangles, and of a scene. */

import { fixed, markdownTable, median } from "../bench/table.mjs";
import { bumpyRing, freshCore, freshMemory, pictureOf, sceneOf } from "./inputs.mjs";

/** @typedef {{ triangles: number, width: number, height: number }} Size */

/** @type {readonly Size[]} */
const sizes = [
  ...[160, 320, 640, 1280, 1920, 3840].map((width) => ({
    ...{ triangles: 20_000, width },
    height: width === 3840 ? 2160 : (3 * width) / 4,
  })),
  ...[100, 1000, 10_000, 100_000, 500_000, 1_000_000].map((triangles) => ({ triangles, width: 640, height: 480 })),
  { triangles: 500_000, width: 3840, height: 2160 },
];
/** Limits in bytes: of the core for this input, and of core and joint module for this scene. */
const large = { triangles: 227_000, width: 1920, height: 1080, limit: 128_000_000 };
const largeScene = { objects: 12, triangles: 100_000, width: 1280, height: 960, limit: 300_000_000 };
/** The stages before and after the search. */
const before = ["observe", "sample", "normals", "prepare"];
const search = ["search", "refine"];

/**
 * Runs a call, and measures the longest time for which it keeps the thread from other work.
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
  const began = performance.now();
  const result = await call();
  const ms = performance.now() - began;
  isOver = true;
  look();
  return { timings: /** @type {Record<string, number>} */ (result.diagnostics.timingsMs), ms, longest };
}

/** @param {Size} size @param {number} runs */
async function measureSize({ triangles, width, height }, runs) {
  const input = pictureOf(bumpyRing(triangles), width, height, 1.6);
  const { aligner, memory } = await freshCore();
  /** @type {Awaited<ReturnType<typeof watched>>[]} */
  const results = [];
  for (let run = 0; run < runs; run++) results.push(await watched(() => aligner.align(input)));
  const stages = [before, search, ["metrics"]].map((names) =>
    median(results.map(({ timings }) => names.reduce((sum, name) => sum + (timings[name] ?? 0), 0))),
  );
  const numbers = [median(results.map(({ ms }) => ms)), ...stages, Math.max(...results.map(({ longest }) => longest))];
  const bytes = memory.buffer.byteLength / 1e6;
  return [`${width} × ${height}`, input.mesh.indices.length / 3, ...[...numbers, bytes].map((x) => fixed(x))];
}

/** @returns {Promise<[name: string, bytes: number, limit: number][]>} */
async function peaks() {
  const input = pictureOf(bumpyRing(large.triangles), large.width, large.height, 2);
  /** @type {[string, number, number][]} */
  const found = [];
  for (const options of [{ quality: "best" }, { preset: "paper" }]) {
    const { aligner, memory: core } = await freshCore();
    const memory = "preset" in options ? await freshMemory("registration") : core;
    await aligner.align(input, options);
    found.push([`one alignment, ${Object.values(options)}`, memory.buffer.byteLength, large.limit]);
  }
  const { aligner, memory: core } = await freshCore();
  const joint = await freshMemory("joint");
  const { objects } = await aligner.alignScene(sceneOf(largeScene));
  for (const { error } of objects) if (error !== undefined) throw error;
  found.push(["a scene of 12 objects", core.buffer.byteLength + joint.buffer.byteLength, largeScene.limit]);
  return found;
}

/**
 * Prints both tables. A peak above its limit fails the command.
 * @param {{ runs: number, quick: boolean }} options
 */
export async function measureSizes({ runs, quick }) {
  const rows = [];
  for (const size of quick ? sizes.slice(0, 2) : sizes) rows.push(await measureSize(size, runs));
  const head = [
    "image",
    "triangles",
    "time, ms",
    "before the search",
    "search",
    "metrics",
    "longest block",
    "memory, MB",
  ];
  console.log(`\n${markdownTable(head, rows)}`);
  const found = await peaks();
  const cells = found.map(([name, bytes, limit]) => [name, fixed(bytes / 1e6, 1), fixed(limit / 1e6)]);
  console.log(`\n${markdownTable(["peak of WebAssembly memory", "MB", "limit, MB"], cells)}`);
  if (found.some(([, bytes, limit]) => bytes > limit)) process.exitCode = 1;
}
