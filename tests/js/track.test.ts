/** Trackers: with and without workers, in order, corrected, lost, and disposed. */
import assert from "node:assert/strict";
import { getEventListeners } from "node:events";
import { after, test } from "node:test";
import { type Aligner, createAligner, type FrameInput } from "sim3align";
import { rejectsWith } from "../support/errors.js";
import { frameAt, turnBetween } from "../support/rig.js";
import { mesh, truth } from "../support/scene.js";
import { Workers } from "../support/workers.js";

const here = await createAligner();
const workers = new Workers();
const pool = await createAligner({ workers: 1, createWorker: workers.create });
after(() => pool.dispose());
const aligners = [here, pool];

const video = [0, 3, 6, 9, 12].map((angle) => frameAt(angle));
const frames = video.map(({ frame }) => frame) as [FrameInput, FrameInput, FrameInput];
const unmasked = (frame: FrameInput): FrameInput => ({ ...frame, mask: undefined });

/** The results of a video whose first frame alone has a mask. */
async function tracked(aligner: Aligner) {
  using tracker = await aligner.track(mesh);
  // At once: they run in their order.
  return await Promise.all(frames.map((frame, k) => tracker.next(k === 0 ? frame : unmasked(frame))));
}

test("frames are tracked in their order, with the same bits in a worker", async () => {
  const found = await tracked(here);
  for (const [k, frame] of found.entries()) {
    assert.deepEqual([frame.frame, frame.state, frame.isDetected], [k, "tracking", k === 0]);
    assert.ok(turnBetween(frame.rotation, video[k]?.pose.rotation ?? []) < 4, `frame ${k}`);
    assert.ok(Math.abs(frame.scale / truth.scale - 1) < 0.04, `frame ${k}: scale ${frame.scale}`);
  }
  assert.deepEqual(await tracked(pool), found);
});

test("a prepared mesh and moved arrays change nothing", async () => {
  using prepared = await pool.prepareMesh(mesh);
  using tracker = await pool.track(prepared, { metrics: true });
  const { input, ...first } = await tracker.next(structuredClone(frames[0]), { transfer: true });
  assert.equal((input?.depth as Float32Array | undefined)?.length, 160 * 120);
  assert.ok((first.metrics?.iou ?? 0) > 0.8);
  using plain = await here.track(mesh, { metrics: true });
  assert.deepEqual((await plain.next(frames[0])).matrix, first.matrix);
});

test("a correction is carried on, and a loss is reported", async () => {
  using tracker = await here.track(mesh);
  const [first, second] = [await tracker.next(frames[0]), await tracker.next(frames[1])];
  const changed = await tracker.correct({ ...second, scale: 1.01 * second.scale });
  assert.equal(changed.map(({ frame }) => frame).join(), "0,1");
  assert.ok(Math.abs((changed[0]?.scale ?? 0) / first.scale / 1.01 - 1) < 1e-6, `${changed[0]?.scale}`);
  const lost = await tracker.next({ ...frames[2], mask: new Uint8Array(160 * 120) });
  assert.deepEqual([lost.state, lost.confidence], ["lost", 0]);
  assert.equal((await tracker.next(frames[2])).state, "tracking");
  await rejectsWith(() => tracker.correct(first, 77), "INVALID_ARGUMENT frame", /77/);
  await rejectsWith(() => tracker.correct({ ...truth, scale: 0 }), "INVALID_TRANSFORM pose");
});

for (const [i, aligner] of aligners.entries()) {
  const name = i === 0 ? "without workers" : "with a worker";

  test(`${name}: what is refused leaves the tracker usable, until it is disposed`, async () => {
    const tracker = await aligner.track(mesh);
    await rejectsWith(() => tracker.next(unmasked(frames[0])), "INVALID_ARGUMENT mask", /mask/);
    await rejectsWith(() => tracker.next({ ...frames[0], maks: 1 } as never), "INVALID_ARGUMENT maks", /maks/);
    const input = { ...frames[0], mesh };
    await rejectsWith(() => tracker.next(input), "INVALID_ARGUMENT mesh", /an input of align\(\).*mesh.*tracker/);
    await assert.rejects(() => tracker.next(frames[0], { signal: AbortSignal.abort(new Error("enough")) }), /enough/);
    assert.equal((await tracker.next(frames[0])).frame, 0);
    tracker.dispose();
    tracker.dispose();
    await rejectsWith(() => tracker.next(frames[0]), "DISPOSED aligner");
    assert.ok((await aligner.evaluate({ ...frames[0], mesh } as never, truth)).metrics.iou);
  });

  test(`${name}: a signal ends the opening, or the tracker, and is let go with it`, async () => {
    const [abort, reason] = [new AbortController(), new Error("no longer needed")];
    const opening = aligner.track(mesh, { signal: abort.signal });
    abort.abort(reason);
    await assert.rejects(opening, reason);
    const { signal } = new AbortController();
    const tracker = await aligner.track(mesh, { signal });
    assert.equal(getEventListeners(signal, "abort").length, 1);
    tracker.dispose();
    assert.equal(getEventListeners(signal, "abort").length, 0);
    const later = new AbortController();
    const open = await aligner.track(mesh, { signal: later.signal });
    later.abort();
    await rejectsWith(() => open.next(frames[0]), "DISPOSED aligner");
  });
}

test("a frame leaves the thread to others, and ends when its tracker is disposed", async () => {
  const tracker = await here.track(mesh, { quality: "best" });
  let isOver = false;
  const first = tracker.next(frames[0]).finally(() => {
    isOver = true;
  });
  await new Promise((resolve) => setTimeout(resolve));
  assert.ok(!isOver, "a timer is called before the frame has ended");
  tracker.dispose();
  await rejectsWith(() => first, "DISPOSED aligner");
});

test("an aligner closes its trackers, and a wrong signal starts no worker", async () => {
  const other = await createAligner();
  const open = await other.track(mesh);
  other.dispose();
  await rejectsWith(() => open.next(frames[0]), "DISPOSED aligner");
  const { length } = workers.made;
  await rejectsWith(() => pool.track(mesh, { signal: 5 as never }), "INVALID_ARGUMENT options.signal", /AbortSignal/);
  assert.equal(workers.made.length, length);
});

test("a tracker whose worker is gone says so, and others are opened", async () => {
  const own = new Workers();
  using one = await createAligner({ workers: 1, createWorker: own.create });
  using tracker = await one.track(mesh);
  await tracker.next(frames[0]);
  for (const worker of own.made) await worker.terminate();
  const lost = ["TRACKER_LOST tracker", /Open another one.*options.initial/] as const;
  await rejectsWith(() => tracker.next(frames[0]), ...lost);
  await rejectsWith(() => tracker.correct(truth), ...lost);
  using again = await one.track(mesh);
  assert.equal((await again.next(frames[0])).state, "tracking");
});
