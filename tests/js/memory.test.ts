/** Memory: calls wait for one another, heaps that have grown are let go, and what does not fit is refused. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { type Aligner, createAligner } from "sim3align";
import { rejectsWith } from "../support/errors.js";
import { withoutTimes } from "../support/results.js";
import { input, mesh, render, truth } from "../support/scene.js";

/** The memory of the newest instance of each WebAssembly module, in the order in which the modules are loaded. */
const heaps = new Map<WebAssembly.Module, WebAssembly.Memory>();
function note(module: WebAssembly.Module, { exports }: WebAssembly.Instance): void {
  const memory = exports.memory as WebAssembly.Memory;
  // Those of Node's own modules are smaller.
  if (memory.buffer.byteLength > 1 << 20) heaps.set(module, memory);
}
const { instantiate, Instance } = WebAssembly;
WebAssembly.instantiate = (async (module: WebAssembly.Module, imports: WebAssembly.Imports) => {
  const instance = await instantiate(module, imports);
  note(module, instance);
  return instance;
}) as typeof instantiate;
WebAssembly.Instance = new Proxy(Instance, {
  construct(Target, [module, imports]) {
    const instance = new Target(module, imports);
    note(module, instance);
    return instance;
  },
});

const quick = { quality: "fast" } as const;
const { mesh: _, ...frame } = input;
const aligner = await createAligner();
const expected = withoutTimes(await aligner.align(input, quick));
const works = async () => assert.deepEqual(withoutTimes(await aligner.align(input, quick)), expected);
// Loads the module of scenes, views and videos.
(await aligner.track(mesh)).dispose();
const names = ["core", "joint"] as const;
type Name = (typeof names)[number];
const heap = (name: Name) => [...heaps.values()][names.indexOf(name)] as WebAssembly.Memory;
const bytesOf = (name: Name) => heap(name).buffer.byteLength;

/** More than an idle heap may have; the pages are never touched. */
const LARGE = 256 * 2 ** 20;
const PAGE = 2 ** 16;
/** Bytes of a heap that cannot grow. */
const ALL = 2 ** 16 * PAGE;
const grow = (name: Name, bytes: number) => heap(name).grow((bytes - bytesOf(name)) / PAGE);

const large = render(mesh, truth, { fx: 900, fy: 900, cx: 639.5, cy: 479.5 }, 1280, 960);

test("calls that begin together take the memory of one", async () => {
  // The first one leaves between its data what the module keeps of the mesh.
  for (let i = 0; i < 2; i++) await aligner.align({ ...large, mesh }, quick);
  const one = bytesOf("core");
  const results = await Promise.all(Array.from({ length: 6 }, () => aligner.align({ ...large, mesh }, quick)));
  assert.equal(bytesOf("core"), one);
  for (const { matrix } of results) assert.deepEqual(matrix, results[0]?.matrix);
});

test("prepared meshes, trackers and calls that fail leave nothing behind", async () => {
  const round = async () => {
    const prepared = await aligner.prepareMesh(mesh);
    await aligner.align({ ...input, mesh: prepared }, quick);
    const tracker = await aligner.track(prepared);
    await tracker.next(frame);
    tracker.dispose();
    prepared.dispose();
    await assert.rejects(aligner.align({ ...input, mask: new Uint8Array(input.mask.length) }), { code: "EMPTY_MASK" });
  };
  for (let i = 0; i < 3; i++) await round();
  const before = names.map(bytesOf);
  for (let i = 0; i < 12; i++) await round();
  assert.deepEqual(names.map(bytesOf), before);
});

test("a heap that has grown is let go when no call waits for it; a prepared mesh keeps its bits", async () => {
  using prepared = await aligner.prepareMesh(mesh);
  const align = async () => withoutTimes(await aligner.align({ ...input, mesh: prepared }, quick));
  assert.deepEqual(await align(), expected);
  grow("core", LARGE);
  const during: number[] = [];
  const onProgress = () => during.push(bytesOf("core"));
  await Promise.all([aligner.align(input, quick), aligner.align(input, { ...quick, onProgress })]);
  assert.ok(during.length > 0 && during.every((bytes) => bytes >= LARGE), `${during}`);
  assert.deepEqual(await align(), expected);
  assert.ok(bytesOf("core") < LARGE / 4);
});

test("a heap in which a tracker lives is let go when the tracker is closed", async () => {
  const tracker = await aligner.track(mesh);
  const { matrix } = await tracker.next(frame);
  grow("joint", LARGE);
  assert.equal((await tracker.next(frame)).frame, 1);
  assert.ok(bytesOf("joint") >= LARGE);
  tracker.dispose();
  await aligner.evaluate(input, truth);
  using again = await aligner.track(mesh);
  assert.deepEqual((await again.next(frame)).matrix, matrix);
  assert.ok(bytesOf("joint") < LARGE / 4);
});

for (const [name, run] of Object.entries({
  core: (one: Aligner) => one.align({ ...large, mesh }, quick),
  joint: (one: Aligner) => one.alignViews({ views: [large], mesh }, quick),
}) as [Name, (one: Aligner) => Promise<unknown>][]) {
  test(`an exhausted heap (${name}) is no trap, and a tracker in it says that it is lost`, async () => {
    using tracker = await aligner.track(mesh);
    await tracker.next(frame);
    grow(name, ALL);
    await rejectsWith(() => run(aligner), "OUT_OF_MEMORY input", /4 GB.*Crop the images/);
    if (name === "joint") await rejectsWith(() => tracker.next(frame), "TRACKER_LOST tracker", /options.initial/);
    else assert.equal((await tracker.next(frame)).frame, 1);
    await works();
    assert.ok(bytesOf(name) < LARGE / 4);
  });
}
