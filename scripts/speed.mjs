/** `npm run speed`: time and memory of this build as WebAssembly in Node; see `--help`. */
import { readdirSync } from "node:fs";
import { availableParallelism } from "node:os";
import { basename } from "node:path";
import { command, count } from "./bench/command.mjs";
import { fixed, markdownTable, median, quantile } from "./bench/table.mjs";
import { buildPackage } from "./lib/package.mjs";
import { sampleDir } from "./lib/paths.mjs";
import { copySample } from "./lib/sample.mjs";
import { bumpyRing, compiledModule, createAligner, freshMemory, pictureOf, sceneOf } from "./speed/inputs.mjs";

/** @typedef {{ only: string[], runs: number, quality: string, quick: boolean }} Options */

const print = (/** @type {string[]} */ head, /** @type {(string | number)[][]} */ rows) =>
  console.log(`\n${markdownTable(head, rows)}`);

/** The time of each of some calls, in milliseconds; the first call, which compiles, does not count. @param {number} runs @param {() => Promise<unknown>} call */
async function timesOf(runs, call) {
  const times = [];
  for (let run = 0; run <= runs; run++) {
    const began = performance.now();
    await call();
    if (run > 0) times.push(performance.now() - began);
  }
  return times;
}

/** The stages of an alignment of case folders. @param {readonly string[]} folders @param {Options} options */
async function stages(folders, { runs, quality }) {
  const { readCaseFolder } = await compiledModule("case-folder.js");
  const aligner = await createAligner();
  for (const folder of folders.length > 0 ? folders : [sampleDir]) {
    const { name, input } = await readCaseFolder(folder);
    /** @type {Record<string, number>[]} */
    const timings = [];
    const whole = await timesOf(runs, async () => {
      timings.push((await aligner.align(input, { quality })).diagnostics.timingsMs);
    });
    const names = Object.keys(timings[0] ?? {});
    const rows = names.map((stage) => [stage, fixed(median(timings.slice(1).map((one) => one[stage] ?? 0)), 1)]);
    print([`${name}, ${quality}`, "ms"], [...rows, ["call, with the same mesh again", fixed(median(whole), 1)]]);
  }
}

/** Numbers of triangles, width and height. */
const sizes = [
  ...[160, 320, 640, 1280, 1920].map((width) => [20_000, width, (3 * width) / 4]),
  [20_000, 3840, 2160],
  ...[100, 1000, 10_000, 100_000, 500_000, 1_000_000].map((triangles) => [triangles, 640, 480]),
  [500_000, 3840, 2160],
];

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
  const { diagnostics } = await call();
  const ms = performance.now() - began;
  isOver = true;
  look();
  return { timings: /** @type {Record<string, number>} */ (diagnostics.timingsMs), ms, longest };
}

/** Time, longest block of the thread and memory by the number of pixels and triangles. @param {readonly string[]} _ @param {Options} options */
async function bySize(_, { runs, quick }) {
  const rows = [];
  for (const [triangles = 0, width = 0, height = 0] of quick ? sizes.slice(0, 2) : sizes) {
    const input = pictureOf(bumpyRing(triangles), width, height, 1.6);
    const [aligner, memory] = [await createAligner(), await freshMemory("core")];
    /** @type {Awaited<ReturnType<typeof watched>>[]} */
    const found = [];
    for (let run = 0; run < runs; run++) found.push(await watched(() => aligner.align(input)));
    const stage = (/** @type {string[]} */ ...names) =>
      median(found.map(({ timings }) => names.reduce((sum, name) => sum + (timings[name] ?? 0), 0)));
    const numbers = [
      median(found.map(({ ms }) => ms)),
      ...[stage("observe", "sample", "normals", "prepare"), stage("search", "refine"), stage("metrics")],
      Math.max(...found.map(({ longest }) => longest)),
      memory.buffer.byteLength / 1e6,
    ];
    rows.push([`${width} × ${height}`, input.mesh.indices.length / 3, ...numbers.map((x) => fixed(x))]);
  }
  const times = ["time, ms", "before the search", "search", "metrics", "longest block"];
  print(["image", "triangles", ...times, "memory, MB"], rows);
  await peaks();
}

/** Peaks of WebAssembly memory. @throws if one is above its limit */
async function peaks() {
  const single = pictureOf(bumpyRing(227_000), 1920, 1080, 2);
  const scene = sceneOf({ objects: 12, triangles: 100_000, width: 1280, height: 960 });
  /** @type {[what: string, limit: number, modules: ("core" | "joint" | "registration")[], call: (aligner: any) => Promise<unknown>][]} */
  const calls = [
    ["align, quality best", 128, ["core"], (aligner) => aligner.align(single, { quality: "best" })],
    ["align, preset paper", 128, ["registration"], (aligner) => aligner.align(single, { preset: "paper" })],
    ["alignScene, 12 objects", 300, ["core", "joint"], (aligner) => aligner.alignScene(scene)],
  ];
  const rows = [];
  for (const [what, limit, modules, call] of calls) {
    const aligner = await createAligner();
    const memories = await Promise.all(modules.map(freshMemory));
    await call(aligner);
    rows.push({ what, limit, used: memories.reduce((sum, { buffer }) => sum + buffer.byteLength / 1e6, 0) });
  }
  print(
    ["peak of WebAssembly memory", "MB", "limit, MB"],
    rows.map(({ what, used, limit }) => [what, fixed(used, 1), limit]),
  );
  const over = rows.filter(({ used, limit }) => used > limit).map(({ what }) => what);
  if (over.length > 0) throw new Error(`Over its limit of memory: ${over.join(", ")}. Remedy: find what grew.`);
}

/** A bumpy ring that turns before a wall. @param {number} count */
function turningRing(count) {
  const mesh = bumpyRing(20_000);
  const frames = Array.from({ length: count }, (_, k) => {
    const [cosine, sine] = [Math.cos((1.5 * k * Math.PI) / 180), Math.sin((1.5 * k * Math.PI) / 180)];
    const positions = mesh.positions.slice();
    for (let i = 0; i < positions.length; i += 3) {
      const [x = 0, y = 0] = positions.subarray(i, i + 2);
      positions.set([x * cosine - y * sine, x * sine + y * cosine], i);
    }
    const { depth, mask, camera, width, height } = pictureOf({ ...mesh, positions }, 640, 480);
    // A thousandth of noise.
    const noisy = depth.map((z, i) => z * (1 + 1e-3 * (((48_271 * i + 7919 * k) % 1009) / 504 - 1)));
    return { depth: noisy, mask, camera, width, height };
  });
  return { name: "turning ring", mesh, frames };
}

/** The decoded frames of a folder. @param {string} folder */
async function readVideo(folder) {
  const { openFrames } = await compiledModule("frames-folder.js");
  const { mesh, names, read } = await openFrames(folder);
  const frames = [];
  for (const name of names) frames.push((await read(name)).input);
  return { name: basename(folder), mesh, frames };
}

/** A tracked frame, with masks in all frames and in the first only. @param {readonly string[]} folders @param {Options} options */
async function video(folders, { runs, quick }) {
  const isVideo = (/** @type {string} */ path) => readdirSync(path).some((name) => name.startsWith("frame_"));
  const read = await Promise.all(folders.filter(isVideo).map(readVideo));
  const aligner = await createAligner();
  const rows = [];
  for (const { name, mesh, frames } of read.length > 0 ? read : [turningRing(quick ? 8 : 60)]) {
    for (const masks of ["all", "first"]) {
      /** @type {number[]} */
      const times = [];
      await timesOf(runs, async () => {
        const tracker = await aligner.track(mesh);
        for (const [k, { mask, ...frame }] of frames.entries()) {
          const began = performance.now();
          await tracker.next(mask !== undefined && (masks === "all" || k === 0) ? { ...frame, mask } : frame);
          // The first frame is searched.
          if (k > 0) times.push(performance.now() - began);
        }
        tracker.dispose();
      });
      const shown = [0.5, 0.95].map((share) => fixed(quantile(times, share), 1));
      rows.push([`${name}, ${frames.length} frames`, masks, ...shown]);
    }
  }
  print(["tracked frame", "masks", "median, ms", "p95, ms"], rows);
}

/** Alignments per second and the time of one by the number of workers, and of an abort. @param {readonly string[]} _ @param {Options} options */
async function pool(_, { runs, quick }) {
  const shapes = [500, 2000, 20_000].map((triangles, i) => pictureOf(bumpyRing(triangles), 160 << i, 120 << i));
  const inputs = Array.from({ length: quick ? 6 : 60 }, (_, i) => shapes[i % shapes.length]);
  const rows = [];
  for (const workers of [0, 1, 2].filter((workers) => workers <= availableParallelism())) {
    const aligner = await createAligner({ workers });
    const all = await timesOf(runs, async () => {
      for await (const { error } of aligner.alignAll(inputs)) if (error !== undefined) throw error;
    });
    const one = await timesOf(runs, () => aligner.align(shapes[1], { quality: "best" }));
    const aborts = await timesOf(runs, async () => {
      const signal = AbortSignal.timeout(20);
      await aligner.align(shapes[2], { quality: "best", signal }).catch(() => {});
    });
    aligner.dispose();
    const cells = [(1000 * inputs.length) / median(all), median(one), median(aborts) - 20];
    rows.push([workers, ...cells.map((x) => fixed(x, 1))]);
  }
  print(["workers", `per second, ${inputs.length} inputs`, "quality best, ms", "abort, ms"], rows);
}

/** @type {Record<string, (folders: readonly string[], options: Options) => Promise<void>>} */
const parts = { stages, sizes: bySize, video, pool };

/** @param {string[]} folders @param {Options} options */
async function measure(folders, options) {
  await buildPackage();
  await copySample();
  const run = options.quick ? { ...options, runs: 1 } : options;
  console.log(`Node ${process.version}, one thread unless workers are named, medians of ${run.runs} runs.`);
  for (const part of run.only) {
    const action = parts[part];
    if (action === undefined)
      throw new Error(`--only: found ${part}, expected some of ${Object.keys(parts).join(", ")}.`);
    await action(folders, run);
  }
}

await command("speed", (program) =>
  program
    .description("Measures time and memory: stages of an alignment, sizes of inputs, a tracked frame, the pool.")
    .argument("[folder...]", "case folders, and folders with frames for --only video; by default the sample")
    .option("--only <part...>", `some of ${Object.keys(parts).join(", ")}`, Object.keys(parts))
    .option("--runs <n>", "runs that count", count, 5)
    .option("--quality <name>", "of the stages", "auto")
    .option("--quick", "one run of the smallest inputs", false)
    .action(measure),
);
