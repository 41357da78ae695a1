/** Prepared meshes: the same bits in every call, and what becomes of them. */
import assert from "node:assert/strict";
import { after, test } from "node:test";
import {
  type AlignInput,
  type Alignment,
  type AlignOptions,
  createAligner,
  type PaperOptions,
  PreparedMesh,
} from "sim3align";
import { rejectsWith } from "../support/errors.js";
import { glb } from "../support/files.js";
import { withoutTimes } from "../support/results.js";
import { frameAt } from "../support/rig.js";
import { input, mesh, truth } from "../support/scene.js";
import { Workers } from "../support/workers.js";

const here = await createAligner();
const workers = new Workers();
const pool = await createAligner({ workers: 1, createWorker: workers.create });
after(() => pool.dispose());

const quick = { quality: "fast" } as const;
const expected = withoutTimes(await here.align(input, quick));
const choices: (AlignOptions | PaperOptions)[] = [
  quick,
  { quality: "best" },
  { preset: "paper", surfaceSamples: 3000, ransacIterations: 2000 },
];

const { metrics } = await here.evaluate(input, truth);
const plain = new Map<typeof mesh | Uint8Array, object[]>();
for (const given of [mesh, glb(mesh)]) {
  const alone = [];
  for (const options of choices) alone.push(withoutTimes(await here.align({ ...input, mesh: given }, options)));
  plain.set(given, alone);
}

for (const [name, aligner] of [
  ["without workers", here],
  ["with a worker", pool],
] as const) {
  test(`${name}: a prepared mesh gives the same bits`, async () => {
    for (const [given, alone] of plain) {
      using prepared = await aligner.prepareMesh(given);
      assert.ok(prepared instanceof PreparedMesh);
      for (const [i, options] of choices.entries()) {
        const found = await aligner.align({ ...input, mesh: prepared }, options);
        assert.deepEqual(withoutTimes(found), alone[i], JSON.stringify(options));
      }
      assert.deepEqual((await aligner.evaluate({ ...input, mesh: prepared }, truth)).metrics, metrics);
    }
  });

  test(`${name}: a disposed mesh is refused, and others go on`, async () => {
    const [first, second] = [await aligner.prepareMesh(mesh), await aligner.prepareMesh(mesh)];
    await aligner.align({ ...input, mesh: first }, quick);
    first.dispose();
    first.dispose();
    await rejectsWith(() => aligner.align({ ...input, mesh: first }), "DISPOSED mesh", /mesh/);
    assert.deepEqual(withoutTimes(await aligner.align({ ...input, mesh: second }, quick)), expected);
    second.dispose();
    const flat = { positions: Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0), indices: Uint32Array.of(0, 1, 2) };
    await rejectsWith(() => aligner.prepareMesh(flat), "DEGENERATE_MESH mesh");
  });

  test(`${name}: a mesh that is disposed of while calls use it serves them to their end`, async () => {
    const prepared = await aligner.prepareMesh(mesh);
    const calls = [0, 1].map(() => aligner.align({ ...input, mesh: prepared }, quick));
    await Promise.resolve();
    prepared.dispose();
    for (const call of calls) assert.deepEqual(withoutTimes(await call), expected);
  });

  test(`${name}: changes of the caller's arrays do not reach it, and it comes back from a transfer`, async () => {
    const own = { positions: mesh.positions.slice(), indices: mesh.indices.slice() };
    using prepared = await aligner.prepareMesh(own);
    own.positions.fill(0);
    let moved: AlignInput = { ...structuredClone(input), mesh: prepared };
    for (let call = 0; call < 2; call++) {
      const { input: back, ...found }: Alignment = await aligner.align(moved, { ...quick, transfer: true });
      assert.deepEqual(withoutTimes(found), expected);
      assert.equal(back?.mesh, prepared);
      moved = back as AlignInput;
    }
  });
}

test("a worker that takes the place of a lost one gets the mesh again; scenes and videos use it, too", async () => {
  using prepared = await pool.prepareMesh(mesh);
  const align = async () => withoutTimes(await pool.align({ ...input, mesh: prepared }, quick));
  assert.deepEqual(await align(), expected);
  await workers.made.at(-1)?.terminate();
  assert.deepEqual(await align(), expected);
  const { mask, mesh: _, ...view } = input;
  const scene = { ...view, objects: [{ mask, mesh: prepared }], support: null };
  const [object] = (await pool.alignScene(scene, quick)).objects;
  assert.deepEqual(object?.error === undefined && object?.matrix, expected.matrix);
  using tracker = await pool.track(prepared);
  assert.equal((await tracker.next({ ...view, mask })).state, "tracking");
  assert.deepEqual(await align(), expected);
});

test("views take prepared meshes and moved arrays, without a change of bits", async () => {
  const views = [0, 120, 240]
    .map((angle) => frameAt(angle))
    .map(({ frame, cameraToWorld }) => ({ ...frame, cameraToWorld }));
  const alone = withoutTimes(await here.alignViews({ mesh, views }, quick));
  using prepared = await pool.prepareMesh(mesh);
  assert.deepEqual(withoutTimes(await pool.alignViews({ mesh: prepared, views }, quick)), alone);
  const moving = structuredClone({ mesh, views });
  const { input: back, ...moved } = await pool.alignViews(moving, { ...quick, transfer: true });
  assert.deepEqual(withoutTimes(moved), alone);
  assert.equal((back?.views[2]?.depth as Float32Array | undefined)?.length, 160 * 120);
  const signal = AbortSignal.abort(new Error("enough"));
  await assert.rejects(() => pool.alignViews({ mesh, views }, { signal }), /enough/);
});

test("a prepared mesh of one aligner serves another, also after the first is gone", async () => {
  const other = await createAligner({ workers: 1 });
  using prepared = await other.prepareMesh(mesh);
  other.dispose();
  assert.deepEqual(withoutTimes(await here.align({ ...input, mesh: prepared }, quick)), expected);
});
