/** Trackers: with and without workers, in order, corrected, lost and closed. */
import assert from "node:assert/strict";
import { getEventListeners } from "node:events";
import { after, test } from "node:test";
import { type Aligner, createAligner, type FrameInput, type Sim3AlignError, TRACK_DEFAULTS } from "sim3align";
import { rejectsWith } from "../support/errors.js";
import { glueModule } from "../support/internals.js";
import { frameAt, turnBetween } from "../support/rig.js";
import { mesh, truth } from "../support/scene.js";
import { Workers } from "../support/workers.js";

const here = await createAligner();
const workers = new Workers();
const pool = await createAligner({ workers: 1, createWorker: workers.create });
after(() => pool.dispose());

const video = [0, 3, 6, 9, 12].map((angle) => frameAt(angle));
const unmasked = (frame: FrameInput): FrameInput => ({ ...frame, mask: undefined });

/** The results of a video whose first frame alone has a mask. */
async function tracked(aligner: Aligner) {
  using tracker = await aligner.track(mesh);
  // At once: they run in their order.
  return await Promise.all(video.map(({ frame }, k) => tracker.next(k === 0 ? frame : unmasked(frame))));
}

test("frames are tracked in their order, with the same bits in a worker", async () => {
  const found = await tracked(here);
  found.forEach((frame, k) => {
    assert.equal(frame.frame, k);
    assert.equal(frame.state, "tracking");
    assert.equal(frame.isDetected, k === 0);
    assert.ok(turnBetween(frame.rotation, video[k]?.pose.rotation ?? []) < 4, `frame ${k}`);
    assert.ok(Math.abs(frame.scale / truth.scale - 1) < 0.04, `frame ${k}: scale ${frame.scale}`);
  });
  assert.deepEqual(await tracked(pool), found);
});

test("a prepared mesh and moved arrays change nothing", async () => {
  using prepared = await pool.prepareMesh(mesh);
  using tracker = await pool.track(prepared, { metrics: true });
  const { input, ...first } = await tracker.next(structuredClone(video[0]?.frame) as FrameInput, { transfer: true });
  assert.equal((input?.depth as Float32Array | undefined)?.length, 160 * 120);
  assert.ok((first.metrics?.iou ?? 0) > 0.8);
});

test("a correction is carried on, and a loss is told", async () => {
  using tracker = await here.track(mesh);
  const frames = video.map(({ frame }) => frame) as [FrameInput, FrameInput, FrameInput];
  const first = await tracker.next(frames[0]);
  const second = await tracker.next(frames[1]);
  const changed = await tracker.correct({ ...second, scale: 1.01 * second.scale });
  assert.deepEqual(
    changed.map(({ frame }) => frame),
    [0, 1],
  );
  assert.ok(Math.abs((changed[0]?.scale ?? 0) / first.scale / ((1.01 * second.scale) / second.scale) - 1) < 1e-6);
  const lost = await tracker.next({ ...frames[2], mask: new Uint8Array(160 * 120) });
  assert.equal(lost.state, "lost");
  assert.equal(lost.confidence, 0);
  assert.equal((await tracker.next(frames[2])).state, "tracking");
  await rejectsWith(() => tracker.correct(first, 77), "INVALID_ARGUMENT frame", /77/);
});

for (const [name, aligner] of [
  ["without workers", here],
  ["with a worker", pool],
] as const) {
  test(`${name}: what is refused leaves the tracker usable, until it is closed`, async () => {
    const frame = video[0]?.frame as FrameInput;
    await rejectsWith(
      () => aligner.track(mesh, { quality: "nice" } as never),
      "INVALID_OPTION options.quality",
      /quality/,
    );
    const tracker = await aligner.track(mesh);
    await rejectsWith(() => tracker.next(unmasked(frame)), "INVALID_ARGUMENT mask", /mask/);
    const misspelt = { ...frame, maks: 1 } as unknown as FrameInput;
    await rejectsWith(() => tracker.next(misspelt), "INVALID_ARGUMENT maks", /maks/);
    await assert.rejects(() => tracker.next(frame, { signal: AbortSignal.abort(new Error("enough")) }), /enough/);
    assert.equal((await tracker.next(frame)).frame, 0);
    tracker.close();
    tracker.close();
    await rejectsWith(() => tracker.next(frame), "DISPOSED aligner");
    // Other calls go on.
    assert.ok((await aligner.alignViews({ mesh, views: [frame as never] }, { quality: "fast" })).scale > 0);
  });
}

for (const [name, aligner] of [
  ["without workers", here],
  ["with a worker", pool],
] as const) {
  test(`${name}: an abort while the tracker opens rejects with its reason, and a signal outlives its trackers`, async () => {
    const abort = new AbortController();
    const reason = new Error("no longer needed");
    const opening = aligner.track(mesh, { signal: abort.signal });
    abort.abort(reason);
    await assert.rejects(opening, reason);
    const { signal } = new AbortController();
    const tracker = await aligner.track(mesh, { signal });
    assert.equal(getEventListeners(signal, "abort").length, 1);
    tracker.close();
    assert.equal(getEventListeners(signal, "abort").length, 0);
  });
}

test("a wrong signal starts no worker", async () => {
  const { length } = workers.made;
  await rejectsWith(() => pool.track(mesh, { signal: 5 as never }), "INVALID_ARGUMENT options.signal", /AbortSignal/);
  assert.equal(workers.made.length, length);
});

test("a signal closes the tracker, and an aligner its trackers", async () => {
  const abort = new AbortController();
  const tracker = await here.track(mesh, { signal: abort.signal });
  abort.abort();
  await rejectsWith(() => tracker.next(video[0]?.frame as FrameInput), "DISPOSED aligner");
  await assert.rejects(() => here.track(mesh, { signal: AbortSignal.abort(new Error("enough")) }), /enough/);
  const other = await createAligner();
  const open = await other.track(mesh);
  other.dispose();
  await rejectsWith(() => open.next(video[0]?.frame as FrameInput), "DISPOSED aligner");
  assert.equal(TRACK_DEFAULTS.metrics, false);
});

test("closed trackers are freed, also those of a disposed aligner", async () => {
  const joint = await glueModule("joint");
  const isOpen = (id: number) => {
    try {
      joint.trackFrame(id, {});
      return true;
    } catch (error) {
      return (error as Sim3AlignError).argument !== "tracker";
    }
  };
  const open = () => Array.from({ length: 100 }, (_, id) => id).filter(isOpen);
  assert.deepEqual(open(), []);
  const other = await createAligner();
  const trackers = [await other.track(mesh), await other.track(mesh)];
  assert.equal(open().length, 2);
  trackers[0]?.close();
  other.dispose();
  await new Promise((resolve) => setImmediate(resolve));
  assert.deepEqual(open(), []);
});
