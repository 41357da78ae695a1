/** Prepared meshes: the same bits, arrays that go to a worker once, and what becomes of them. */
import assert from "node:assert/strict";
import { after, test } from "node:test";
import { type AlignInput, type Alignment, createAligner, type OptionsOf, PreparedMesh } from "sim3align";
import { rejectsWith } from "../support/errors.js";
import { glb } from "../support/files.js";
import { glueModule } from "../support/internals.js";
import { input, mesh, truth } from "../support/scene.js";
import { Workers, withoutTimes } from "../support/workers.js";

const here = await createAligner();
const workers = new Workers();
const pool = await createAligner({ workers: 1, createWorker: workers.create });
after(() => pool.dispose());

const choices: OptionsOf<"precise" | "paper", boolean>[] = [
  {},
  { quality: "fast" },
  { preset: "paper" },
  { quality: "fast", metrics: false },
];

for (const [name, aligner] of [
  ["without workers", here],
  ["with a worker", pool],
] as const) {
  test(`${name}: a prepared mesh gives the same bits`, async () => {
    for (const given of [mesh, glb(mesh)]) {
      using prepared = await aligner.prepareMesh(given);
      assert.ok(prepared instanceof PreparedMesh);
      for (const options of choices) {
        const expected = withoutTimes(await here.align({ ...input, mesh: given }, options));
        const found = await aligner.align({ ...input, mesh: prepared }, options);
        assert.deepEqual(withoutTimes(found), expected, JSON.stringify(options));
      }
      const expected = await here.evaluate(input, truth);
      assert.deepEqual((await aligner.evaluate({ ...input, mesh: prepared }, truth)).metrics, expected.metrics);
    }
  });

  test(`${name}: a disposed mesh is refused, and others go on`, async () => {
    const [first, second] = [await aligner.prepareMesh(mesh), await aligner.prepareMesh(mesh)];
    await aligner.align({ ...input, mesh: first }, { quality: "fast" });
    first.dispose();
    first.dispose();
    await rejectsWith(() => aligner.align({ ...input, mesh: first }), "DISPOSED mesh", /mesh/);
    assert.ok((await aligner.align({ ...input, mesh: second }, { quality: "fast" })).scale > 0);
    second.dispose();
  });

  test(`${name}: a mesh without volume is refused when it is prepared`, async () => {
    const flat = { positions: Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0), indices: Uint32Array.of(0, 1, 2) };
    await rejectsWith(() => aligner.prepareMesh(flat), "DEGENERATE_MESH mesh", /mesh/);
    await rejectsWith(
      () => aligner.prepareMesh({ positions: [0, 1] } as never),
      "INVALID_ARGUMENT mesh.positions",
      /Float32Array/,
    );
  });

  test(`${name}: changes of the caller's arrays do not reach a prepared mesh`, async () => {
    const own = { positions: mesh.positions.slice(), indices: mesh.indices.slice() };
    using prepared = await aligner.prepareMesh(own);
    own.positions.fill(0);
    const expected = withoutTimes(await here.align(input, { quality: "best" }));
    assert.deepEqual(withoutTimes(await aligner.align({ ...input, mesh: prepared }, { quality: "best" })), expected);
  });

  test(`${name}: with transfer, the prepared mesh comes back and stays usable`, async () => {
    using prepared = await aligner.prepareMesh(mesh);
    let moved: AlignInput = { ...structuredClone(input), mesh: prepared };
    for (let call = 0; call < 2; call++) {
      const result: Alignment = await aligner.align(moved, { quality: "fast", transfer: true });
      assert.equal(result.input?.mesh, prepared);
      moved = result.input as AlignInput;
    }
    const error = await aligner.align({ ...moved, mask: new Uint8Array(3) }, { transfer: true }).then(
      () => assert.fail("a mask of three pixels"),
      (error: { input?: AlignInput }) => error,
    );
    if (aligner === pool) assert.equal(error.input?.mesh, prepared);
  });
}

test("a worker gets the arrays once, and a worker that takes its place gets them again", async () => {
  const own = new Workers();
  const sent: number[] = [];
  const create = () => {
    const worker = own.create();
    const post = worker.postMessage.bind(worker);
    worker.postMessage = (message: { type: string; job?: { method: string; data: AlignInput } }, ...rest) => {
      if (/^(align|place)$/.test(message.job?.method ?? "") && message.job)
        sent.push((message.job.data.mesh as typeof mesh).positions.length);
      post(message, ...rest);
    };
    return worker;
  };
  const one = await createAligner({ workers: 1, createWorker: create });
  using prepared = await here.prepareMesh(mesh);
  const align = () => one.align({ ...input, mesh: prepared }, { quality: "fast" });
  const expected = withoutTimes(await align());
  assert.deepEqual(withoutTimes(await align()), expected);
  await (await own.nth(0)).terminate();
  assert.deepEqual(withoutTimes(await align()), expected);
  const whole = mesh.positions.length;
  assert.deepEqual(sent.splice(0), [whole, 0, whole]);
  // The joint module has a cache of its own.
  const { mask, mesh: _, ...view } = input;
  const scene = { ...view, objects: [{ mask, mesh: prepared }], support: null };
  const [object] = (await one.alignScene(scene, { quality: "fast" })).objects;
  assert.deepEqual(object?.error === undefined && object?.matrix, expected.matrix);
  assert.deepEqual(withoutTimes(await align()), expected);
  assert.deepEqual(sent, [whole, 0, 0]);
  one.dispose();
});

test("a disposed mesh is freed in all modules", async () => {
  const [joint, core] = [await glueModule("joint"), await glueModule("core")];
  const tracker = 10_000;
  const uses: ((mesh: object) => void)[] = [
    (mesh) => {
      joint.openTracker(tracker, { mesh }, {});
      joint.closeTracker(tracker);
    },
    (mesh) => core.prepareMesh(mesh),
  ];
  /** Those of the first meshes that each module has. */
  const kept = () =>
    uses.map((use) =>
      Array.from({ length: 100 }, (_, id) => id).filter((id) => {
        try {
          use({ positions: new Float32Array(), id });
          return true;
        } catch {
          return false;
        }
      }),
    );
  const prepared = await here.prepareMesh(mesh);
  (await here.track(prepared)).close();
  const before = kept();
  prepared.dispose();
  const gone = before.map((ids, i) => ids.filter((id) => !kept()[i]?.includes(id)));
  assert.equal(gone[0]?.length, 1);
  assert.deepEqual(gone[1], gone[0]);
});

test("a prepared mesh of one aligner serves another, also after the first is gone", async () => {
  const other = await createAligner({ workers: 1 });
  const prepared = await other.prepareMesh(mesh);
  other.dispose();
  const expected = withoutTimes(await here.align(input));
  assert.deepEqual(withoutTimes(await here.align({ ...input, mesh: prepared })), expected);
  prepared.dispose();
});
