/** Workers: the same bits, whoever does the work; what becomes of a worker that is lost; many inputs, few at a time. */
import assert from "node:assert/strict";
import { after, test } from "node:test";
import { type AlignInput, type AlignOptions, createAligner, type PaperOptions, Sim3AlignError } from "sim3align";
import { rejectsWith } from "../support/errors.js";
import { glb, npy, png } from "../support/files.js";
import { brick, input, mesh, transformed, truth } from "../support/scene.js";
import { Gate, slowInput, Workers, withoutTimes } from "../support/workers.js";

const here = await createAligner();
const pools = await Promise.all([1, 2, 3].map((workers) => createAligner({ workers })));
const [, pool = here] = pools;
after(() => {
  for (const each of pools) each.dispose();
});

const quick = { quality: "fast" } as const;

test("any number of workers gives the same bits", async () => {
  const poses: (AlignOptions | PaperOptions)[] = [
    {},
    { quality: "best" },
    { quality: "fast", seed: 5, scale: [0.05, 0.2], cameraUp: [0, -1, 0.2], meshUp: [0, 1, 0] },
    { quality: "fast", initial: truth },
    { quality: "fast", initial: truth, search: "local", scale: truth.scale },
    { preset: "paper" },
  ];
  for (const options of poses) {
    const expected = withoutTimes(await here.align(brick, options));
    for (const [i, aligner] of pools.entries()) {
      const found = withoutTimes(await aligner.align(brick, options));
      assert.deepEqual(found, expected, `${i + 1} workers, ${JSON.stringify(options)}`);
    }
  }
});

test("the core is compiled once, however many aligners there are: workers are handed the module", async (t) => {
  const compile = t.mock.method(WebAssembly, "compile");
  const handed: unknown[] = [];
  const workers = new Workers();
  const createWorker = () => {
    const worker = workers.create();
    const post = worker.postMessage.bind(worker);
    worker.postMessage = (message, transfer) => {
      if (message.type === "start") handed.push(message.core);
      post(message, transfer);
    };
    return worker;
  };
  const aligner = await createAligner({ workers: 3, createWorker });
  assert.ok((await aligner.align(input, quick)).scale > 0);
  aligner.dispose();
  assert.equal(handed.length, 3);
  assert.equal(new Set(handed).size, 1);
  assert.ok(handed[0] instanceof WebAssembly.Module);
  assert.equal(compile.mock.callCount(), 0, "the aligners before had it compiled");
});

test("evaluate, register and estimateSim3 run in workers too", async () => {
  assert.deepEqual(
    (await pool.evaluate(input, truth, { truth })).metrics,
    (await here.evaluate(input, truth, { truth })).metrics,
  );
  const source = Float64Array.from(mesh.positions.slice(0, 3000));
  const target = transformed(source, truth);
  const pairs = Uint32Array.from({ length: 2000 }, (_, i) => Math.floor(i / 2));
  for (const aligner of [here, pool]) {
    const found = await aligner.estimateSim3(source, target, pairs);
    assert.ok(Math.abs(found.scale - truth.scale) < 1e-9);
  }
  const settings = { seed: 2, ransacIterations: 2000 };
  const [there, own] = await Promise.all(
    [pool, here].map((aligner) => aligner.register(mesh.positions, transformed(mesh.positions, truth), settings)),
  );
  assert.deepEqual([there?.matrix, there?.fitness, there?.residual], [own?.matrix, own?.fitness, own?.residual]);
});

test("files are decoded in the workers", async () => {
  const { depth, mask, width, height, camera } = input;
  const files: AlignInput = {
    depth: npy(depth, height, width),
    mask: new Blob([png(mask, width, height) as Uint8Array<ArrayBuffer>]),
    cameraFile: JSON.stringify(camera),
    mesh: glb(mesh),
  };
  const expected = withoutTimes(await here.align(files, quick));
  assert.deepEqual(withoutTimes(await pool.align(files, quick)), expected);
});

test("errors are those of this thread: class, code, argument and message", async () => {
  const bad: [AlignInput, AlignOptions][] = [
    [{ ...input, depth: new Float32Array(7) }, {}],
    [{ ...input, mask: new Uint8Array(input.mask.length) }, {}],
    [{ ...input, mesh: new Uint8Array(9) }, {}],
    [{ ...input, mesh: { positions: Float32Array.of(0, 0, 0, 1, 1, 1, 2, 2, 2) } }, {}],
    [input, { search: "local" }],
    [input, { voxelDivision: 3 } as AlignOptions],
    [input, { initial: { scale: 1, rotation: [0, 0, 0, 1], translation: [0, 0, -1] } }],
    // What can't be sent to a worker is refused here.
    [{ ...input, mesh: () => mesh } as unknown as AlignInput, {}],
    [input, { seed: Symbol("seed") as unknown as number }],
  ];
  for (const [faulty, options] of bad) {
    const calls = [here.align(faulty, options), pool.align(faulty, options)];
    const outcomes = await Promise.allSettled(calls);
    const [own, ...others] = outcomes.map((call): unknown => (call.status === "rejected" ? call.reason : call.value));
    assert.ok(own instanceof Sim3AlignError, JSON.stringify(own));
    for (const error of others) {
      assert.ok(error instanceof Sim3AlignError, String(error));
      assert.equal(error.code, own.code);
      assert.equal(error.argument, own.argument);
      assert.equal(error.message, own.message);
    }
  }
});

test("the arguments are left as they were, views into larger buffers too", async () => {
  const room = new Float32Array(input.depth.length + 10);
  room.set(input.depth, 5);
  const view = { ...input, depth: room.subarray(5, 5 + input.depth.length) };
  assert.deepEqual(withoutTimes(await pool.align(view, quick)), withoutTimes(await here.align(input, quick)));
  assert.equal(room.length, input.depth.length + 10);
  assert.deepEqual(view.depth, input.depth);
});

test("with transfer the arrays are moved, and handed back", async () => {
  const moved = structuredClone(input);
  const begun = new Gate();
  const call = pool.align(moved, { ...quick, transfer: true, onProgress: begun.open });
  await begun.opened;
  const { input: back } = await call;
  assert.equal(moved.depth.length, 0, "moved");
  assert.deepEqual(back, input);
  const again = await pool.align(back as AlignInput, { ...quick, transfer: true });
  assert.deepEqual(again.input, input);

  const faulty = { ...structuredClone(input), depthScale: -1 };
  await assert.rejects(pool.align(faulty, { transfer: true }), (error) => {
    assert.ok(error instanceof Sim3AlignError);
    assert.deepEqual((error.input as AlignInput).mesh, input.mesh);
    return true;
  });
  assert.equal(faulty.depth.length, 0);

  const clouds = [Float32Array.from(mesh.positions), Float32Array.from(mesh.positions)] as const;
  const { input: cloudsBack } = await pool.register(...clouds, { transfer: true, ransacIterations: 500 });
  assert.equal(clouds[0].length, 0);
  assert.deepEqual(cloudsBack?.source, mesh.positions);
});

test("what can't be moved is copied: Node's pooled buffers, shared memory, and everything without workers", async () => {
  const shared = new Float32Array(new SharedArrayBuffer(input.depth.byteLength));
  shared.set(input.depth);
  const unmovable = { ...input, depth: shared, mask: Uint8Array.from(input.mask), mesh: structuredClone(mesh) };
  const { input: back } = await pool.align(unmovable, { ...quick, transfer: true });
  assert.deepEqual((back as typeof input).depth, input.depth);

  const same = await here.align(input, { ...quick, transfer: true });
  assert.equal(same.input, input);
  assert.ok(input.depth.length > 0);
});

test("arrays that have been moved before are refused by name, and the worker goes on", async () => {
  const one = await createAligner({ workers: 1 });
  const moved = structuredClone(input);
  const [first, second] = await Promise.allSettled([
    one.align(moved, { ...quick, transfer: true }),
    one.align(moved, { ...quick, transfer: true }),
  ]);
  assert.ok(first.status === "fulfilled" && second.status === "rejected");
  const expected = ["INVALID_ARGUMENT depth", /detached.*transfer: true/] as const;
  await rejectsWith(() => Promise.reject(second.reason), ...expected);
  assert.deepEqual(withoutTimes(await one.align(input, quick)), withoutTimes(await here.align(input, quick)));
  const file = { ...input, mesh: glb(mesh) };
  assert.ok((await one.align(file, quick)).scale > 0, "the file readers load");
  one.dispose();
});

/** Leaves the calls' reports to {@link Workers}, which sees that a worker is busy by them. */
const onProgress = () => {};

test("a worker that is lost is replaced, and its job is run again", async () => {
  const workers = new Workers();
  const aligner = await createAligner({ workers: 2, createWorker: workers.create });
  const slow = { quality: "best", onProgress } as const;
  const expected = withoutTimes(await here.align(slowInput, slow));
  const calls = [aligner.align(slowInput, slow), aligner.align(slowInput, slow)];
  const both = [await workers.nth(0), await workers.nth(1)];
  await Promise.all(both.map(({ isBusy }) => isBusy));
  await Promise.all(both.map((worker) => worker.terminate()));
  for (const call of calls) assert.deepEqual(withoutTimes(await call), expected);
  assert.equal(workers.made.length, 4);
  aligner.dispose();
});

test("a job that loses two workers fails, and others go on", async () => {
  const workers = new Workers();
  const aligner = await createAligner({ workers: 1, createWorker: workers.create });
  const lost = aligner.align(slowInput, { quality: "best", onProgress });
  const next = aligner.align(input, quick);
  const failure = rejectsWith(() => lost, "WORKER_FAILED workers", /exit code/);
  for (const n of [0, 1]) {
    const worker = await workers.nth(n);
    await worker.isBusy;
    await worker.terminate();
  }
  await failure;
  assert.ok((await next).scale > 0);
  aligner.dispose();
});

test("each call reports workers that cannot start", async () => {
  const { Worker } = await import("node:worker_threads");
  const broken = [
    () => new Worker("throw new Error('no such script')", { eval: true }),
    () => {
      throw new Error("not allowed here");
    },
  ];
  for (const createWorker of broken) {
    const aligner = await createAligner({ workers: 2, createWorker });
    for (let i = 0; i < 2; i++) {
      await rejectsWith(() => aligner.align(input, quick), "WORKER_FAILED workers", /no such|not allowed/);
    }
    assert.ok(aligner.version);
    aligner.dispose();
  }
});

test("disposing ends the workers, and what waits for them", async () => {
  const workers = new Workers();
  const aligner = await createAligner({ workers: 1, createWorker: workers.create });
  const slow = { quality: "best", onProgress } as const;
  const calls = [aligner.align(slowInput, slow), aligner.align(input), aligner.evaluate(input, truth)];
  const worker = await workers.nth(0);
  await worker.isBusy;
  aligner.dispose();
  const expected = ["DISPOSED aligner", /createAligner\(\)/] as const;
  for (const call of calls) await rejectsWith(() => call, ...expected);
  await rejectsWith(() => aligner.align(input), ...expected);
  await worker.ended();
  assert.equal(workers.made.length, 1);
});

for (const workers of [-1, 1.5, 1000, "many", Number.NaN]) {
  test(`${workers} workers are refused`, async () => {
    const refused = createAligner({ workers: workers as number });
    await rejectsWith(() => refused, "INVALID_ARGUMENT workers", /auto/);
  });
}

/** Inputs with other seeds' worth of noise, counted as they are pulled. */
class Source {
  pulled = 0;
  isClosed = false;

  constructor(
    private readonly count: number,
    private readonly faulty = -1,
  ) {}

  *[Symbol.iterator](): Generator<AlignInput> {
    try {
      for (let i = 0; i < this.count; i++) {
        this.pulled += 1;
        yield i === this.faulty ? { ...input, mesh: { positions: new Float32Array(3) } } : i % 3 === 0 ? brick : input;
      }
    } finally {
      this.isClosed = true;
    }
  }
}

for (const [name, aligner, workers] of [
  ["without workers", here, 0.5],
  ["with one worker", pools[0] ?? here, 1],
  ["with three workers", pools[2] ?? here, 3],
] as const) {
  test(`alignAll ${name} yields all, pulls no more than it has room for, and goes on after a bad input`, async () => {
    for (const ordered of [true, false]) {
      const source = new Source(9, 4);
      const seen = new Map<number, unknown>();
      for await (const { index, alignment, error } of aligner.alignAll(source, { ...quick, ordered })) {
        assert.ok(source.pulled - seen.size <= 2 * workers, `${source.pulled} pulled, ${seen.size} yielded`);
        assert.ok(!seen.has(index));
        if (ordered) assert.equal(index, seen.size);
        if (index === 4) {
          assert.ok(error instanceof Sim3AlignError && alignment === undefined);
        } else {
          assert.ok(alignment !== undefined && alignment.scale > 0);
        }
        seen.set(index, alignment ?? error);
      }
      assert.equal(seen.size, 9);
      assert.deepEqual(
        [...seen.keys()].sort((a, b) => a - b),
        [0, 1, 2, 3, 4, 5, 6, 7, 8],
      );
    }
  });

  test(`alignAll ${name}: leaving the loop ends it, and the aligner works on`, async () => {
    const source = new Source(1000);
    for await (const { index } of aligner.alignAll(source, { ...quick, ordered: true })) {
      if (index === 2) break;
    }
    assert.ok(source.isClosed);
    assert.ok(source.pulled <= 3 + 2 * workers, `${source.pulled}`);
    assert.ok((await aligner.align(input, quick)).scale > 0);
  });
}

test("alignAll takes inputs that come slowly, yields what is ready meanwhile, and hands arrays back", async () => {
  let release = () => {};
  const gate = new Promise<void>((resolve) => {
    release = resolve;
  });
  async function* slowly() {
    yield structuredClone(input);
    await gate;
    yield structuredClone(input);
  }
  const indices: number[] = [];
  for await (const { index, input: back, alignment } of pool.alignAll(slowly(), { ...quick, transfer: true })) {
    assert.ok(alignment !== undefined);
    assert.deepEqual(back, input);
    indices.push(index);
    release();
  }
  assert.deepEqual(indices, [0, 1]);
});

test("alignAll throws what the inputs throw, and options that are none are each input's error", async () => {
  const failure = new Error("disk full");
  function* failing() {
    yield input;
    throw failure;
  }
  const drain = async (results: AsyncIterable<unknown>) => {
    for await (const _ of results);
  };
  await assert.rejects(drain(pool.alignAll(failing(), quick)), (error) => error === failure);
  for await (const { error } of pool.alignAll([input], { voxelDivision: 1 } as object)) {
    assert.equal(error?.code, "UNKNOWN_OPTION");
  }
  const disposed = await createAligner({ workers: 1 });
  const results = disposed.alignAll([input, input], quick);
  disposed.dispose();
  await assert.rejects(drain(results), { code: "DISPOSED" });
});
