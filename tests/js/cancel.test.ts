/** Cancelling and progress, with workers and without. */
import assert from "node:assert/strict";
import { after, test } from "node:test";
import { type Aligner, createAligner, type Progress } from "sim3align";
import { rejectsWith } from "../support/errors.js";
import { sourceModule } from "../support/internals.js";
import { input, truth } from "../support/scene.js";
import { Gate, slowInput, Workers, withoutTimes } from "../support/workers.js";

const here = await createAligner();
const pool = await createAligner({ workers: 2 });
after(() => pool.dispose());

const quick = { quality: "fast" } as const;
const slow = { quality: "best" } as const;
const aligners: [string, Aligner][] = [
  ["without workers", here],
  ["with workers", pool],
];
const isAbort = (error: unknown) => error instanceof DOMException && error.name === "AbortError";

for (const [name, aligner] of aligners) {
  test(`${name}: what is aborted before it begins does not begin`, async () => {
    const signal = AbortSignal.abort();
    await assert.rejects(aligner.align(input, { signal }), isAbort);
    await assert.rejects(aligner.evaluate(input, truth, { signal }), isAbort);
    await assert.rejects(aligner.register(new Float32Array(9), new Float32Array(9), { signal }), isAbort);
    const pairs = new Uint32Array(6);
    await assert.rejects(aligner.estimateSim3(new Float32Array(9), new Float32Array(9), pairs, { signal }), isAbort);
    await assert.rejects(async () => {
      for await (const _ of aligner.alignAll([input], { signal }));
    }, isAbort);
  });

  test(`${name}: estimateSim3 ends at an abort, and at its budget, whatever its options allow`, async () => {
    const count = 20_000;
    const points = Float64Array.from({ length: 3 * count }, (_, i) => Math.sin(i * i));
    // Every point has a partner that has nothing to do with it.
    const pairs = Uint32Array.from({ length: 2 * count }, (_, i) => (i % 2 === 0 ? i / 2 : (i * 7919) % count));
    const endless = { ransacIterations: 10_000_000, edgeSimilarity: 0, inlierDistance: 1e-3 };
    const signal = AbortSignal.timeout(20);
    await assert.rejects(
      aligner.estimateSim3(points, points, pairs, { ...endless, signal }),
      (error) => error === signal.reason,
    );
    await rejectsWith(
      () => aligner.estimateSim3(points, points, pairs, { ...endless, workBudget: 20 }),
      "NO_CONSENSUS correspondences",
      /minimal sets/,
    );
  });

  test(`${name}: register ends at an abort, whatever its options allow`, async () => {
    const count = 60_000;
    const points = Float64Array.from({ length: 3 * count }, (_, i) => Math.sin(i * i));
    const large = { maxPoints: 1_000_000, voxelDivisions: 200 };
    for (const scale of ["free", 1] as const) {
      const signal = AbortSignal.timeout(20);
      await assert.rejects(
        aligner.register(points, points.slice().reverse(), { ...large, scale, signal }),
        (error) => error === signal.reason,
      );
    }
  });

  test(`${name}: the signal's own reason is what the call rejects with`, async () => {
    const reason = new TypeError("the user has left");
    const controller = new AbortController();
    const call = aligner.align(slowInput, { ...slow, signal: controller.signal });
    controller.abort(reason);
    await assert.rejects(call, (error) => error === reason);
  });

  test(`${name}: aborting between the stages ends the call, and the next one has the same bits as ever`, async () => {
    const expected = withoutTimes(await here.align(input, quick));
    const controller = new AbortController();
    const stages: string[] = [];
    const onProgress = ({ stage }: Progress) => {
      stages.push(stage);
      if (stage === "prepare") controller.abort();
    };
    await assert.rejects(aligner.align(slowInput, { ...slow, signal: controller.signal, onProgress }), isAbort);
    assert.ok(!stages.includes("metrics"), `${stages}`);
    assert.deepEqual(withoutTimes(await aligner.align(input, quick)), expected);
  });

  test(`${name}: what onProgress throws ends the call`, async () => {
    const failure = new TypeError("not now");
    let calls = 0;
    const onProgress = () => {
      calls += 1;
      throw failure;
    };
    await assert.rejects(aligner.align(slowInput, { ...slow, onProgress }), (error) => error === failure);
    assert.equal(calls, 1);
    assert.ok((await aligner.align(input, quick)).scale > 0);
  });

  test(`${name}: progress rises to 1, and its last pose is the result's`, async () => {
    const seen: Progress[] = [];
    const { matrix, diagnostics } = await aligner.align(slowInput, {
      ...slow,
      onProgress: (progress) => seen.push(progress),
    });
    assert.equal(seen[0]?.best, undefined);
    const { best } = seen.at(-1) ?? {};
    assert.deepEqual([Array.from(best?.matrix ?? []), best?.score], [matrix, diagnostics.score]);
    assert.equal(seen.at(-1)?.fraction, 1);
    for (const [i, { fraction }] of seen.entries()) {
      assert.ok(fraction >= (seen[i - 1]?.fraction ?? 0) && fraction <= 1, `${fraction}`);
    }
  });

  test(`${name}: a signal that is none is refused`, async () => {
    const signal = { aborted: false } as AbortSignal;
    await rejectsWith(() => aligner.align(input, { signal }), "INVALID_ARGUMENT options.signal", /AbortSignal/);
  });

  test(`${name}: alignAll ends when its signal does, also while it waits for an input`, async () => {
    const controller = new AbortController();
    async function* stuck() {
      yield input;
      controller.abort();
      await new Promise(() => {});
    }
    const indices: number[] = [];
    await assert.rejects(async () => {
      for await (const { index } of aligner.alignAll(stuck(), { ...quick, signal: controller.signal })) {
        indices.push(index);
      }
    }, isAbort);
    assert.ok(indices.length <= 1);
  });
}

test("without workers: an abort that comes from a timer ends a call that is under way", async (t) => {
  // On this clock, each piece of work takes longer than the thread may be blocked, on machines of any speed.
  let time = 0;
  t.mock.method(performance, "now", () => {
    time += 1000;
    return time;
  });
  const controller = new AbortController();
  const stages: string[] = [];
  const onProgress = ({ stage }: Progress) => {
    // Only a thread that gets its turn can run the timer.
    if (stage === "search" && !stages.includes(stage)) setTimeout(() => controller.abort());
    stages.push(stage);
  };
  await assert.rejects(here.align(input, { ...quick, signal: controller.signal, onProgress }), isAbort);
  assert.ok(stages.includes("search") && !stages.includes("metrics"), `${stages}`);
});

test("aborting ends the worker and its job, and the job that waits for it is not touched", async () => {
  const own = new Workers();
  const one = await createAligner({ workers: 1, createWorker: own.create });
  const controller = new AbortController();
  const begun = new Gate();
  const running = one.align(slowInput, { ...slow, signal: controller.signal, onProgress: begun.open });
  const waiting = one.align(input, quick);
  await begun.opened;
  controller.abort();
  await assert.rejects(running, isAbort);
  await own.made[0]?.ended();
  assert.equal(own.made.length, 2, "it was replaced");
  assert.deepEqual(withoutTimes(await waiting), withoutTimes(await here.align(input, quick)));
  one.dispose();
});

test("a job that waits can be aborted, and is not done", async () => {
  const one = await createAligner({ workers: 1 });
  const running = one.align(input, quick);
  const controller = new AbortController();
  const moved = structuredClone(input);
  const waiting = one.align(moved, { ...quick, signal: controller.signal, transfer: true });
  controller.abort();
  await assert.rejects(waiting, isAbort);
  assert.deepEqual(moved.depth, input.depth, "it was not moved");
  assert.ok((await running).scale > 0);
  assert.ok((await one.align(input, quick)).scale > 0);
  one.dispose();
});

test("a hundred calls with one signal leave no listener behind", async () => {
  const { signal } = new AbortController();
  let listeners = 0;
  const { addEventListener, removeEventListener } = signal;
  signal.addEventListener = (...args: Parameters<typeof addEventListener>) => {
    listeners += 1;
    addEventListener.apply(signal, args);
  };
  signal.removeEventListener = (...args: Parameters<typeof removeEventListener>) => {
    listeners -= 1;
    removeEventListener.apply(signal, args);
  };
  const warnings: Error[] = [];
  const warn = (warning: Error) => warnings.push(warning);
  process.on("warning", warn);
  const calls = Array.from({ length: 100 }, () => pool.evaluate(input, truth, { signal }));
  await Promise.all(calls);
  process.off("warning", warn);
  assert.equal(listeners, 0);
  assert.deepEqual(warnings, [], "Node sees no leak");
});

test("a task is freed when it fails, also where it runs at once, as in a worker", async () => {
  const { perform } = await sourceModule("jobs.js");
  const failure = new Error("no consensus");
  let freed = 0;
  const task = {
    step() {
      throw failure;
    },
    free: () => {
      freed += 1;
    },
  };
  const core = {
    instance: 0,
    call: (work: (glue: object) => unknown) => work({ beginAlign: () => task }),
    keep() {},
    drop() {},
  };
  await assert.rejects(perform({ method: "align", data: input, options: {} }, { core }), failure);
  assert.equal(freed, 1);
});
