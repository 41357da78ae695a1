/**
 * `npm run soak` runs this: soak.js COUNT SEED. Alignments of mixed inputs through a pool, while workers are killed,
 * calls aborted and bad inputs passed. Every call must settle, the bits must be those of the input alone, and the memory
 * must not grow.
 */
import assert from "node:assert/strict";
import { Worker } from "node:worker_threads";
import { type Aligner, type AlignInput, createAligner, type PreparedMesh, Sim3AlignError } from "sim3align";
import { glb, maskPng, npy } from "./files.js";
import { Random } from "./random.js";
import { withoutTimes } from "./results.js";
import { blob, render, truth } from "./scene.js";
import { workerUrl } from "./workers.js";

const WORKERS = 2;
/** Calls in flight: more than workers, so that some wait. */
const LANES = 6;

const [count = 10_000, seed = 1] = process.argv.slice(2).map(Number);
const random = new Random(seed);
const meshes = [blob(8, 10), blob(12, 16)] as const;
const camera = (width: number, height: number) => ({ fx: 1.9 * width, fy: 1.9 * width, cx: width / 2, cy: height / 2 });
const sizes = [
  [32, 24],
  [48, 36],
  [64, 48],
] as const;

/** The inputs: arrays and files, of two meshes in three images. */
const inputs: AlignInput[] = meshes.flatMap((mesh) =>
  sizes.flatMap(([width, height]): AlignInput[] => {
    const view = render(mesh, truth, camera(width, height), width, height);
    const depth = npy(view.depth, height, width);
    const mask = maskPng(view.mask, width, height);
    return [
      { ...view, mesh },
      { depth, mask, camera: view.camera, mesh: glb(mesh) },
    ];
  }),
);

const here = await createAligner();
const alone: string[] = [];
const bits = (result: Awaited<ReturnType<Aligner["align"]>>) => {
  const { input: _, ...rest } = result;
  return JSON.stringify(withoutTimes(rest));
};
for (const input of inputs) alone.push(bits(await here.align(input, { quality: "fast" })));

const workers = new Set<Worker>();
const createWorker = () => {
  const worker = new Worker(workerUrl);
  workers.add(worker);
  worker.once("exit", () => workers.delete(worker));
  return worker;
};
const pool = await createAligner({ workers: WORKERS, createWorker });
const prepared: PreparedMesh[] = [];
for (const mesh of meshes) prepared.push(await pool.prepareMesh(mesh));

const counts = {
  aligned: 0,
  "aligned, arrays moved": 0,
  "aligned, prepared mesh": 0,
  "bad inputs refused": 0,
  "calls aborted": 0,
  "workers killed": 0,
  "failed with WORKER_FAILED": 0,
};

/** One call, and what it must come to. */
async function call(): Promise<void> {
  const index = random.whole(0, inputs.length - 1);
  const input = inputs[index] as AlignInput;
  const kind = random.between(0, 1);
  if (kind < 0.05) {
    const bad = [{ mask: new Uint8Array(9) }, { depth: [1, 2] }, { mesh: new Uint8Array(40) }, { camera: { fx: 0 } }];
    const change = bad[random.whole(0, bad.length - 1)];
    await assert.rejects(pool.align({ ...input, ...change } as AlignInput), Sim3AlignError);
    counts["bad inputs refused"] += 1;
    return;
  }
  const controller = new AbortController();
  const isAborted = kind < 0.12;
  const options = { quality: "fast", signal: controller.signal } as const;
  const isMoved = kind > 0.8;
  const isPrepared = kind > 0.6 && !isMoved && !(input.mesh instanceof Uint8Array);
  const given = isMoved ? structuredClone(input) : isPrepared ? { ...input, mesh: meshOf(input) } : input;
  const aligning = pool.align(given, { ...options, transfer: isMoved });
  if (isAborted) setTimeout(() => controller.abort(), random.whole(0, 20));
  try {
    const found = bits(await aligning);
    assert.equal(found, alone[index], `input ${index}: other bits than alone`);
    counts[isMoved ? "aligned, arrays moved" : isPrepared ? "aligned, prepared mesh" : "aligned"] += 1;
  } catch (error) {
    if (isAborted && controller.signal.aborted && error === controller.signal.reason) counts["calls aborted"] += 1;
    else if (error instanceof Sim3AlignError && error.code === "WORKER_FAILED")
      counts["failed with WORKER_FAILED"] += 1;
    else throw error;
  }
  if (random.between(0, 1) < 0.02) kill();
}

const meshOf = ({ mesh }: AlignInput) => prepared[(meshes as readonly unknown[]).indexOf(mesh)] as PreparedMesh;

/** Kills a worker, whatever it does. */
function kill(): void {
  const [worker] = workers;
  if (worker === undefined) return;
  counts["workers killed"] += 1;
  worker.terminate();
}

const rows: [done: number, seconds: number, residentMb: number, heapMb: number, workers: number][] = [];
const started = performance.now();
function measure(done: number): void {
  (globalThis as { gc?: () => void }).gc?.();
  const { rss, heapUsed } = process.memoryUsage();
  rows.push([done, (performance.now() - started) / 1000, rss / 1e6, heapUsed / 1e6, workers.size]);
  console.error(`${done} of ${count}: ${Math.round(rss / 1e6)} MB`);
}

let begun = 0;
let settled = 0;
const step = Math.max(1, Math.floor(count / 10));
await Promise.all(
  Array.from({ length: LANES }, async () => {
    while (begun < count) {
      begun += 1;
      await call();
      settled += 1;
      if (settled % step === 0) measure(settled);
    }
  }),
);
for (const mesh of prepared) mesh.dispose();
pool.dispose();

const table = (head: readonly string[], cells: readonly (readonly unknown[])[]) =>
  [head, head.map(() => "--:"), ...cells].map((row) => `| ${row.join(" | ")} |`).join("\n");
console.log(
  `\n${table(
    ["calls settled", "s", "resident MB", "heap MB", "workers"],
    rows.map(([done, s, rss, heap, size]) => [done, s.toFixed(0), rss.toFixed(0), heap.toFixed(1), size]),
  )}\n`,
);
console.log(`${table(["outcome", "calls"], Object.entries(counts))}\n`);
assert.equal(settled, count, "a call that did not settle");
// The first tenth fills caches of the engine: what grows afterwards, grows with the calls.
const [first, last] = [rows[Math.floor(rows.length / 3)], rows.at(-1)];
if (first !== undefined && last !== undefined && last[2] > 1.25 * first[2]) {
  console.error(`The memory has grown from ${first[2].toFixed(0)} to ${last[2].toFixed(0)} MB.`);
  process.exitCode = 1;
}
