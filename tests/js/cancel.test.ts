/** Cancelling and listeners of progress, with workers and without. */
import assert from "node:assert/strict";
import { getEventListeners } from "node:events";
import { test } from "node:test";
import { type Aligner, createAligner, type Progress } from "sim3align";
import { pools } from "../support/aligners.js";
import { rejectsWith } from "../support/errors.js";
import { withoutTimes } from "../support/results.js";
import { input, truth } from "../support/scene.js";
import { Gate, slowInput, Workers } from "../support/workers.js";

const here = await createAligner();
const [pool] = await pools(2);

const quick = { quality: "fast" } as const;
const slow = { quality: "best" } as const;
const expected = withoutTimes(await here.align(input, quick));
const works = async (aligner: Aligner) => assert.deepEqual(withoutTimes(await aligner.align(input, quick)), expected);
const reason = new TypeError("the user has left");
const isReason = (error: unknown) => error === reason;

const count = 20_000;
const points = Float64Array.from({ length: 3 * count }, (_, i) => Math.sin(i * i));
// Every point has a partner that has nothing to do with it.
const pairs = Uint32Array.from({ length: 2 * count }, (_, i) => (i % 2 === 0 ? i / 2 : (i * 7919) % count));
const endless = { ransacIterations: 10_000_000, edgeSimilarity: 0, inlierDistance: 1e-3 };

for (const [name, aligner] of [
  ["without workers", here],
  ["with workers", pool],
] as const) {
  test(`${name}: what is aborted before it begins does not begin`, async () => {
    const signal = AbortSignal.abort();
    const cloud = new Float32Array(9);
    const calls = [
      () => aligner.align(input, { signal }),
      () => aligner.evaluate(input, truth, { signal }),
      () => aligner.register(cloud, cloud, { signal }),
      () => aligner.estimateSim3(cloud, cloud, new Uint32Array(6), { signal }),
      () => aligner.prepareMesh(input.mesh, { signal }),
    ];
    for (const call of calls) await assert.rejects(call, { name: "AbortError" });
  });

  test(`${name}: long calls of every kind end at an abort, with the signal's own reason, and at their budget`, async () => {
    const large = { maxPoints: 1_000_000, voxelDivisions: 200 };
    const calls: ((signal: AbortSignal) => Promise<unknown>)[] = [
      (signal) => aligner.align(slowInput, { ...slow, signal }),
      (signal) => aligner.estimateSim3(points, points, pairs, { ...endless, signal }),
      (signal) => aligner.register(points, points.slice().reverse(), { ...large, signal }),
      (signal) => aligner.register(points, points.slice().reverse(), { ...large, scale: 1, signal }),
    ];
    for (const call of calls) {
      const controller = new AbortController();
      const running = call(controller.signal);
      setTimeout(() => controller.abort(reason), 10);
      await assert.rejects(running, isReason);
    }
    await works(aligner);
    const bounded = () => aligner.estimateSim3(points, points, pairs, { ...endless, workBudget: 20 });
    await rejectsWith(bounded, "NO_CONSENSUS correspondences", /minimal sets/);
  });

  test(`${name}: what onProgress throws, or rejects with, ends the call, and not the process`, async () => {
    const listeners = [
      () => {
        throw reason;
      },
      () => Promise.reject(reason),
    ];
    for (const onProgress of listeners as (() => never)[]) {
      await assert.rejects(aligner.align(slowInput, { ...slow, onProgress }), isReason);
      await works(aligner);
    }
    // A promise that rejects after the call is of no account; an unhandled rejection would fail the file.
    const late: (() => void)[] = [];
    const onProgress = () => new Promise<void>((_, reject) => late.push(() => reject(reason)));
    assert.deepEqual(withoutTimes(await aligner.align(input, { ...quick, onProgress })), expected);
    for (const reject of late) reject();
    await new Promise((resolve) => setImmediate(resolve));
  });

  test(`${name}: progress rises to 1, and its last pose is the result's`, async () => {
    const seen: Progress[] = [];
    const onProgress = (progress: Progress) => seen.push(progress);
    const { matrix, diagnostics } = await aligner.align(slowInput, { ...slow, onProgress });
    const { best, fraction } = seen.at(-1) as Progress;
    assert.deepEqual([Array.from(best?.matrix ?? []), best?.score, fraction], [matrix, diagnostics.score, 1]);
    for (const [i, one] of seen.entries()) assert.ok(one.fraction >= (seen[i - 1]?.fraction ?? 0), `${one.fraction}`);
  });
}

test("without workers: the thread gets its turn, so that a timer can end a call that is under way", async (t) => {
  // On this clock, each piece of work takes longer than the thread may be blocked, on machines of any speed.
  let time = 0;
  t.mock.method(performance, "now", () => {
    time += 1000;
    return time;
  });
  const controller = new AbortController();
  const stages: string[] = [];
  const onProgress = ({ stage }: Progress) => {
    if (stage === "search" && !stages.includes(stage)) setTimeout(() => controller.abort(reason));
    stages.push(stage);
  };
  await assert.rejects(here.align(input, { ...quick, signal: controller.signal, onProgress }), isReason);
  assert.ok(stages.includes("search") && !stages.includes("metrics"), `${stages}`);
});

test("aborting ends the worker and its job, and the job that waits for it is not touched", async () => {
  const own = new Workers();
  using one = await createAligner({ workers: 1, createWorker: own.create });
  const controller = new AbortController();
  const begun = new Gate();
  const running = one.align(slowInput, { ...slow, signal: controller.signal, onProgress: begun.open });
  const waiting = one.align(input, quick);
  await begun.opened;
  controller.abort(reason);
  await assert.rejects(running, isReason);
  await own.made[0]?.ended();
  assert.equal(own.made.length, 2, "it was replaced");
  assert.deepEqual(withoutTimes(await waiting), expected);
});

test("many calls with one signal leave no listener behind", async () => {
  const { signal } = new AbortController();
  const warnings: Error[] = [];
  const warn = (warning: Error) => warnings.push(warning);
  process.on("warning", warn);
  await Promise.all(Array.from({ length: 30 }, () => pool.evaluate(input, truth, { signal })));
  process.off("warning", warn);
  assert.deepEqual([getEventListeners(signal, "abort").length, warnings], [0, []]);
});
