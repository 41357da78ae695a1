/** Workers: the same bits, whoever does the work; moved arrays; and what becomes of workers that are lost. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { Worker } from "node:worker_threads";
import { type Aligner, type AlignInput, type AlignOptions, createAligner, type PaperOptions } from "sim3align";
import { pools } from "../support/aligners.js";
import { rejectsWith } from "../support/errors.js";
import { glb } from "../support/files.js";
import { bits, withoutTimes } from "../support/results.js";
import { brick, input, mesh, transformed, truth } from "../support/scene.js";
import { tableScene } from "../support/table.js";
import { Gate, slowInput, Workers } from "../support/workers.js";

const here = await createAligner();
const [pool, large] = await pools(1, 3);

const quick = { quality: "fast" } as const;
/** Hard, so that idle workers help. */
const hard = { quality: "best" } as const;
const expected = withoutTimes(await here.align(input, quick));
const works = async (aligner: Aligner) => assert.deepEqual(withoutTimes(await aligner.align(input, quick)), expected);

const source = Float64Array.from(mesh.positions.slice(0, 3000));
const target = transformed(source, truth);
const pairs = Uint32Array.from({ length: 2000 }, (_, i) => Math.floor(i / 2));
const { mesh: _, mask, ...view } = brick;
const relative = { ...input, depth: input.depth.map((z) => 1 / z), depthKind: "affine-invariant-disparity" } as const;
const views = [view, view, view].map((one) => ({ ...one, mask }));
const poses: (AlignOptions | PaperOptions)[] = [
  {},
  hard,
  { ...quick, seed: 5, scale: [0.05, 0.2], cameraUp: [0, -1, 0.2], meshUp: [0, 1, 0] },
  { ...quick, initial: truth, search: "local", scale: truth.scale },
  { preset: "paper", surfaceSamples: 3000, ransacIterations: 2000 },
];
const calls: Record<string, (aligner: Aligner) => Promise<unknown>> = {
  ...Object.fromEntries(
    poses.map((options) => [`align ${JSON.stringify(options)}`, (aligner: Aligner) => aligner.align(brick, options)]),
  ),
  "align relative depth": (aligner) => aligner.align(relative, quick),
  evaluate: (aligner) => aligner.evaluate(input, truth, { truth }),
  register: (aligner) => aligner.register(source, target, { seed: 2, ransacIterations: 2000 }),
  estimateSim3: (aligner) => aligner.estimateSim3(source, target, pairs),
  alignViews: (aligner) => aligner.alignViews({ mesh: brick.mesh, views }, quick),
  alignScene: (aligner) => aligner.alignScene(tableScene, quick),
};

for (const [name, call] of Object.entries(calls)) {
  test(`any number of workers gives the same bits: ${name}`, async () => {
    const alone = bits(await call(here));
    for (const aligner of [pool, large]) {
      // Twice: the second time, all workers have started and may help.
      for (let i = 0; i < 2; i++) assert.ok(bits(await call(aligner)) === alone);
    }
  });
}

test("with transfer the arrays are moved, and handed back, with an error too", async () => {
  const moved = structuredClone(input);
  const begun = new Gate();
  const call = pool.align(moved, { ...quick, transfer: true, onProgress: begun.open });
  await begun.opened;
  const { input: back } = await call;
  assert.equal(moved.depth.length, 0, "moved");
  assert.deepEqual(back, input);
  const faulty = { ...structuredClone(input), depthScale: -1 };
  await assert.rejects(pool.align(faulty, { transfer: true }), (error: { input?: AlignInput }) => {
    assert.deepEqual(error.input?.mesh, input.mesh);
    return true;
  });
  assert.equal(faulty.depth.length, 0);
  const clouds = [mesh.positions.slice(), mesh.positions.slice()] as const;
  const { input: cloudsBack } = await pool.register(...clouds, { transfer: true, ransacIterations: 500 });
  assert.deepEqual([clouds[0].length, cloudsBack?.source], [0, mesh.positions]);
});

test("arrays that were moved before, or while their call waits, are refused by name, and the worker goes on", async () => {
  using one = await createAligner({ workers: 1 });
  const moved = structuredClone(input);
  const first = one.align(moved, { ...quick, transfer: true });
  await rejectsWith(
    () => one.align(moved, { ...quick, transfer: true }),
    "INVALID_ARGUMENT depth",
    /detached.*transfer/,
  );
  assert.ok((await first).scale > 0);
  const busy = one.align(input, quick);
  const waiting = structuredClone(input);
  const late = one.align(waiting, quick);
  structuredClone(waiting.mask, { transfer: [waiting.mask.buffer] });
  await rejectsWith(() => late, "INVALID_ARGUMENT mask", /detached/);
  assert.deepEqual(withoutTimes(await busy), expected);
  assert.ok((await one.align({ ...input, mesh: glb(mesh) }, quick)).scale > 0, "the file readers load");
});

/** Leaves the calls' reports to {@link Workers}, which sees that a worker is busy by them. */
const slow = { ...hard, onProgress: () => {} };

test("workers that are lost are replaced, and their jobs are run again", async () => {
  const workers = new Workers();
  using aligner = await createAligner({ workers: 2, createWorker: workers.create });
  const alone = withoutTimes(await here.align(slowInput, hard));
  const running = [aligner.align(slowInput, slow), aligner.align(slowInput, slow)];
  const both = [await workers.nth(0), await workers.nth(1)];
  await Promise.all(both.map(({ isBusy }) => isBusy));
  await Promise.all(both.map((worker) => worker.terminate()));
  for (const call of running) assert.deepEqual(withoutTimes(await call), alone);
  assert.equal(workers.made.length, 4);
});

test("a job that loses two workers fails, as does one whose arrays were moved to a lost one; others go on", async () => {
  for (const transfer of [false, true]) {
    const workers = new Workers();
    using aligner = await createAligner({ workers: 1, createWorker: workers.create });
    const lost = aligner.align(transfer ? structuredClone(slowInput) : slowInput, { ...slow, transfer });
    const next = aligner.align(input, quick);
    const failure = rejectsWith(() => lost, "WORKER_FAILED workers", /exit code/);
    for (const n of transfer ? [0] : [0, 1]) {
      const worker = await workers.nth(n);
      await worker.isBusy;
      await worker.terminate();
    }
    await failure;
    assert.deepEqual(withoutTimes(await next), expected);
  }
});

test("workers that help and are killed at any time lose no call and change no bit", async () => {
  const alone = withoutTimes(await here.align(brick, hard));
  for (const delay of [0, 5, 20, 40]) {
    const workers = new Workers();
    using aligner = await createAligner({ workers: 3, createWorker: workers.create });
    await Promise.all(workers.made.map(() => aligner.align(input, quick)));
    const call = aligner.align(brick, hard);
    setTimeout(() => workers.made[delay % 3]?.terminate(), delay);
    assert.deepEqual(withoutTimes(await call), alone);
    await works(aligner);
  }
});

const scripts = {
  "cannot start": ["throw new Error('no such script')", 60_000, /no such script/],
  "says nothing": ["require('node:worker_threads').parentPort.on('message', () => {})", 50, /no answer for 50 ms/],
  "is another program": [
    "const { parentPort } = require('node:worker_threads'); parentPort.on('message', () => parentPort.postMessage('hello'))",
    60_000,
    /a message that worker.js does not send/,
  ],
} as const;

for (const [name, [script, workerStartMs, message]] of Object.entries(scripts)) {
  test(`each call reports a worker that ${name}, and keeps its arrays`, async () => {
    const createWorker = () => new Worker(script, { eval: true });
    using aligner = await createAligner({ workers: 1, createWorker, workerStartMs });
    for (let i = 0; i < 2; i++) {
      const moved = structuredClone(input);
      const call = () => aligner.align(moved, { ...quick, transfer: true });
      await rejectsWith(call, "WORKER_FAILED workers", message);
      assert.ok(moved.depth.length > 0, "it got no arrays that it could lose");
    }
  });
}

test("single calls go before the inputs of a batch that wait for a worker", async () => {
  using one = await createAligner({ workers: 1 });
  const done: string[] = [];
  const note = (name: string) => () => done.push(name);
  const begun = new Gate();
  const single = begun.opened.then(() => one.evaluate(input, truth)).then(note("single"));
  const reported = ({ index }: { index: number }) => index === 0 && begun.open();
  for await (const { index } of one.alignAll([input, input, input], { ...quick, onProgress: reported })) {
    note(`input ${index}`)();
  }
  await single;
  assert.deepEqual(done, ["input 0", "single", "input 1", "input 2"]);
});

test("errors of workers, and of frames, have the stack of the call", async () => {
  using one = await createAligner({ workers: 1 });
  const tracker = await one.track(mesh);
  const callers: Record<string, () => Promise<unknown>> = {
    alignWrongly: () => one.align({ ...input, depthScale: -1 }),
    trackWrongly: () => tracker.next({ ...view, camera: { ...view.camera, fx: -1 } }),
    alignWronglyHere: () => here.align({ ...input, depthScale: -1 }),
  };
  for (const [name, call] of Object.entries(callers)) {
    await assert.rejects(call, ({ stack, message }: Error) => {
      assert.ok(stack?.startsWith(`Sim3AlignError: ${message}\n`), stack);
      assert.match(stack ?? "", new RegExp(`${name}.*pool\\.test`));
      return true;
    });
  }
});

test("disposing ends the workers, and what waits for them", async () => {
  const workers = new Workers();
  const aligner = await createAligner({ workers: 1, createWorker: workers.create });
  const running = [aligner.align(slowInput, slow), aligner.align(input), aligner.evaluate(input, truth)];
  const worker = await workers.nth(0);
  await worker.isBusy;
  aligner.dispose();
  for (const call of [...running, aligner.align(input)]) {
    await rejectsWith(() => call, "DISPOSED aligner", /createAligner\(\)/);
  }
  await worker.ended();
  assert.equal(workers.made.length, 1);
});
