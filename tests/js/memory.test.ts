/** Memory: calls wait for one another, what does not fit is refused, and heaps that have grown are let go. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { Worker } from "node:worker_threads";
import { type Aligner, createAligner, Sim3AlignError } from "sim3align";
import { rejectsWith } from "../support/errors.js";
import { glueModule } from "../support/internals.js";
import { input, mesh, render, truth } from "../support/scene.js";
import { Workers, withoutTimes, workerUrl } from "../support/workers.js";

const quick = { quality: "fast" } as const;
const aligner = await createAligner();
const expected = withoutTimes(await aligner.align(input, quick));

type Name = "core" | "joint";
// Loads the joint module.
(await aligner.track(mesh)).close();
const heap = async (name: Name): Promise<WebAssembly.Memory> => (await glueModule(name)).initSync().memory;
const bytesOf = async (name: Name) => (await heap(name)).buffer.byteLength;

/** More than an idle heap may have; the pages are never touched. */
const LARGE = 256 * 2 ** 20;
/** Pages of a heap that cannot grow. */
const ALL = 2 ** 16;
const PAGE = 2 ** 16;

/** Makes the heap of a module so large, or as large as a heap can be. */
async function grow(name: Name, bytes: number): Promise<void> {
  const memory = await heap(name);
  memory.grow(bytes / PAGE - memory.buffer.byteLength / PAGE);
}

const { mesh: _, ...frame } = input;
const largeFrame = render(mesh, truth, { fx: 900, fy: 900, cx: 639.5, cy: 479.5 }, 1280, 960);
const large = { ...largeFrame, mesh };

test("calls that begin together take the memory of one", async () => {
  // The first one leaves between its data what the module keeps of the mesh.
  for (let i = 0; i < 2; i++) await aligner.align(large, quick);
  const one = await bytesOf("core");
  const results = await Promise.all(Array.from({ length: 12 }, () => aligner.align(large, quick)));
  assert.equal(await bytesOf("core"), one);
  for (const result of results) assert.deepEqual(result.matrix, results[0]?.matrix);
});

test("calls of several aligners wait in their order; one that waits ends at its abort, and at the end of its aligner", async () => {
  const other = await createAligner();
  const order: string[] = [];
  const named = (name: string, call: Promise<unknown>) =>
    call.then(
      () => order.push(name),
      (error) => order.push(`${name}: ${error instanceof Sim3AlignError ? error.code : error}`),
    );
  const abort = new AbortController();
  const calls = [
    named("first", aligner.align(large, quick)),
    named("second", other.align(input, quick)),
    named("aborted", aligner.align(input, { ...quick, signal: abort.signal })),
    named("evaluated", aligner.evaluate(input, truth)),
  ];
  await new Promise((resolve) => setTimeout(resolve));
  abort.abort("enough");
  other.dispose();
  await Promise.all(calls);
  assert.deepEqual([...order].sort(), ["aborted: enough", "evaluated", "first", "second: DISPOSED"]);
  // The two did not wait for the first.
  assert.deepEqual(order.slice(-2), ["first", "evaluated"]);
});

test("scenes wait for one another, and their objects do not", async () => {
  const { mask, ...view } = frame;
  const scene = { ...view, objects: [{ mask, mesh }] };
  const poses = await Promise.all([1, 2].map(async () => (await aligner.alignScene(scene, quick)).objects[0]));
  assert.ok(poses[0] !== undefined && poses[0].error === undefined && poses[1]?.error === undefined);
  assert.deepEqual(poses[0].matrix, poses[1]?.matrix);
});

test("a heap that has grown is let go when no call runs; a prepared mesh is prepared again, with the same bits", async () => {
  using prepared = await aligner.prepareMesh(mesh);
  assert.deepEqual(withoutTimes(await aligner.align({ ...input, mesh: prepared }, quick)), expected);
  await grow("core", LARGE);
  assert.deepEqual(withoutTimes(await aligner.align({ ...input, mesh: prepared }, quick)), expected);
  assert.ok((await bytesOf("core")) < LARGE / 4);
  assert.deepEqual(withoutTimes(await aligner.align({ ...input, mesh: prepared }, quick)), expected);
});

test("a heap stays while calls wait for it", async () => {
  await grow("core", LARGE);
  const glue = await glueModule("core");
  const during: number[] = [];
  const onProgress = () => during.push(glue.initSync().memory.buffer.byteLength);
  await Promise.all([aligner.align(input, quick), aligner.align(input, { ...quick, onProgress })]);
  assert.ok(during.length > 0 && during.every((bytes) => bytes >= LARGE), `${during}`);
  assert.ok((await bytesOf("core")) < LARGE / 4);
});

test("a heap in which a tracker lives is let go when the tracker is closed", async () => {
  const tracker = await aligner.track(mesh);
  const first = (await tracker.next(frame)).matrix;
  await grow("joint", LARGE);
  const second = await tracker.next(frame);
  assert.equal(second.frame, 1);
  assert.ok((await bytesOf("joint")) >= LARGE);
  tracker.close();
  await aligner.evaluate(input, truth);
  assert.ok((await bytesOf("joint")) < LARGE / 4);
  using again = await aligner.track(mesh);
  assert.deepEqual((await again.next(frame)).matrix, first);
});

test("a worker lets go of a heap that has grown, and gets a prepared mesh again", async () => {
  const glue = new URL("wasm/core.js", workerUrl).href;
  // Before every job but the first, the heap is made too large.
  const script = `
    const { parentPort } = require("node:worker_threads");
    const on = parentPort.on.bind(parentPort);
    let jobs = 0;
    parentPort.on = (name, listen) => {
      on(name, async (message) => {
        if (message?.type === "job" && jobs++ > 0) {
          const { memory } = await (await import(${JSON.stringify(glue)})).default();
          memory.grow(${LARGE / PAGE});
        }
        listen(message);
      });
    };
    import(${JSON.stringify(workerUrl.href)});`;
  using pool = await createAligner({ workers: 1, createWorker: () => new Worker(script, { eval: true }) });
  using prepared = await pool.prepareMesh(mesh);
  for (let call = 0; call < 3; call++) {
    assert.deepEqual(withoutTimes(await pool.align({ ...input, mesh: prepared }, quick)), expected);
  }
});

test("what cannot fit is refused with a code of its own, and the next call has the same bits", async () => {
  const side = 2 ** 13 + 1;
  const depth = new Float32Array(side * side);
  const found = ["OUT_OF_MEMORY depth", /an array of 269 MB, expected at most 268 MB/] as const;
  await rejectsWith(
    () => aligner.align({ ...input, depth, width: side, height: side, mask: new Uint8Array(4) }),
    ...found,
  );
  assert.deepEqual(withoutTimes(await aligner.align(input, quick)), expected);
});

for (const [name, run] of Object.entries({
  core: (a: Aligner) => a.align(large, quick),
  joint: (a: Aligner) => a.alignViews({ views: [largeFrame], mesh }, quick),
})) {
  test(`an exhausted heap (${name}) is no trap`, async () => {
    await grow(name as Name, ALL * PAGE);
    const exhausted = ["OUT_OF_MEMORY input", /4 GB.*Crop the images/] as const;
    await rejectsWith(() => run(aligner), ...exhausted);
    assert.ok((await bytesOf(name as Name)) < LARGE / 4);
    assert.deepEqual(withoutTimes(await aligner.align(input, quick)), expected);
  });
}

test("a tracker whose memory or worker is gone says so", async () => {
  const lost = ["TRACKER_LOST tracker", /Open another one.*options.initial/] as const;
  using tracker = await aligner.track(mesh);
  await tracker.next(frame);
  await grow("joint", ALL * PAGE);
  await rejectsWith(() => aligner.alignViews({ views: [largeFrame], mesh }, quick), "OUT_OF_MEMORY input");
  await rejectsWith(() => tracker.next(frame), ...lost);
  await rejectsWith(() => tracker.correct(truth), ...lost);
  const workers = new Workers();
  using pool = await createAligner({ workers: 1, createWorker: workers.create });
  using distant = await pool.track(mesh);
  await distant.next(frame);
  for (const worker of workers.made) await worker.terminate();
  await rejectsWith(() => distant.next(frame), ...lost);
  await rejectsWith(() => distant.correct(truth), ...lost);
});
