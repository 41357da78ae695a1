/** `alignAll`: many inputs, few at a time. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { type AlignInput, createAligner, Sim3AlignError } from "sim3align";
import { pools } from "../support/aligners.js";
import { withoutTimes } from "../support/results.js";
import { brick, input } from "../support/scene.js";

const here = await createAligner();
const [pool, large] = await pools(1, 3);

const quick = { quality: "fast" } as const;
const alone = await Promise.all([brick, input].map(async (one) => withoutTimes(await here.align(one, quick))));

/** Inputs that are counted as they are pulled, one of which is bad. */
class Source {
  pulled = 0;
  isClosed = false;

  constructor(private readonly count: number) {}

  *[Symbol.iterator](): Generator<AlignInput> {
    try {
      for (let i = 0; i < this.count; i++) {
        this.pulled += 1;
        yield i === 4 ? { ...input, mesh: { positions: new Float32Array(3) } } : i % 3 === 0 ? brick : input;
      }
    } finally {
      this.isClosed = true;
    }
  }
}

async function drain(results: AsyncIterable<unknown>): Promise<void> {
  for await (const _ of results);
}

for (const [name, aligner, workers] of [
  ["without workers", here, 0.5],
  ["with one worker", pool, 1],
  ["with three workers", large, 3],
] as const) {
  test(`${name}: all are yielded, no more are pulled than there is room for, a bad input is an error of its own`, async () => {
    for (const ordered of [true, false]) {
      const source = new Source(9);
      const seen: number[] = [];
      for await (const { index, alignment, error } of aligner.alignAll(source, { ...quick, ordered })) {
        assert.ok(source.pulled - seen.length <= 2 * workers, `${source.pulled} pulled, ${seen.length} yielded`);
        if (ordered) assert.equal(index, seen.length);
        if (index === 4) assert.ok(error instanceof Sim3AlignError && alignment === undefined);
        else assert.deepEqual(alignment && withoutTimes(alignment), alone[index % 3 === 0 ? 0 : 1]);
        seen.push(index);
      }
      assert.deepEqual(seen.sort(), [0, 1, 2, 3, 4, 5, 6, 7, 8]);
    }
  });

  test(`${name}: leaving the loop ends it, a signal too, and the aligner works on`, async () => {
    const source = new Source(1000);
    for await (const { index } of aligner.alignAll(source, { ...quick, ordered: true })) if (index === 2) break;
    assert.ok(source.isClosed && source.pulled <= 3 + 2 * workers, `${source.pulled}`);
    const controller = new AbortController();
    async function* stuck() {
      yield input;
      controller.abort();
      await new Promise(() => {});
    }
    await assert.rejects(drain(aligner.alignAll(stuck(), { ...quick, signal: controller.signal })), {
      name: "AbortError",
    });
    assert.deepEqual(withoutTimes(await aligner.align(input, quick)), alone[1]);
  });
}

test("inputs may come slowly: what is ready is yielded meanwhile, and moved arrays are handed back", async () => {
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

test("what the inputs throw is thrown, wrong options are each input's error, a disposed aligner ends the loop", async () => {
  const failure = new Error("disk full");
  function* failing() {
    yield input;
    throw failure;
  }
  await assert.rejects(drain(pool.alignAll(failing(), quick)), (error) => error === failure);
  for await (const { error } of pool.alignAll([input], { voxelDivision: 1 } as object)) {
    assert.equal(error?.code, "UNKNOWN_OPTION");
  }
  const disposed = await createAligner({ workers: 1 });
  const results = disposed.alignAll([input, input], quick);
  disposed.dispose();
  await assert.rejects(drain(results), { code: "DISPOSED" });
});
