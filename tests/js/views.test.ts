/** Several views: known and unknown cameras, with and without workers, and what is refused. */
import assert from "node:assert/strict";
import { after, test } from "node:test";
import { createAligner, VIEWS_DEFAULTS, type ViewsInput } from "sim3align";
import { type Fault, rejectsWith } from "../support/errors.js";
import { withoutTimes } from "../support/results.js";
import { frameAt, turnBetween } from "../support/rig.js";
import { mesh, truth } from "../support/scene.js";

const here = await createAligner();
const pool = await createAligner({ workers: 1 });
after(() => pool.dispose());

const rig = [0, 120, 240].map((angle) => frameAt(angle));
const known: ViewsInput = { mesh, views: rig.map(({ frame, cameraToWorld }) => ({ ...frame, cameraToWorld })) };
const unknown: ViewsInput = { mesh, views: rig.map(({ frame }) => frame) };

test("known cameras: one pose in the world, and in each view", async () => {
  const found = await here.alignViews(known);
  assert.equal(found.world, "given");
  assert.ok(Math.abs(found.scale / truth.scale - 1) < 0.02, `scale ${found.scale}`);
  assert.ok(turnBetween(found.rotation, truth.rotation) < 3);
  found.views.forEach((view, k) => {
    assert.equal(view.role, "used");
    assert.ok(turnBetween(view.rotation, rig[k]?.pose.rotation ?? []) < 3, `view ${k}`);
    assert.ok((view.metrics?.iou ?? 0) > 0.8, `view ${k}`);
  });
  assert.ok(found.confidence > 0.5 && found.uncertainty !== null);
  assert.equal("metrics" in ((await here.alignViews(known, { metrics: false })).views[0] ?? {}), false);
});

test("known cameras show the proportions of a mesh together", async () => {
  const narrow = { ...mesh, positions: mesh.positions.map((x, i) => (i % 3 === 0 ? 0.95 * x : x)) };
  const input = { ...known, mesh: narrow };
  const { proportions, matrix } = await here.alignViews(input, { proportions: "axes", metrics: false });
  assert.ok(proportions !== undefined);
  const [x, y, z] = [0, 1, 2].map((k) => (proportions.stretch[k]?.[k] ?? 0) * proportions.scale) as [
    number,
    number,
    number,
  ];
  for (const [length, expected] of [
    [x, truth.scale / 0.95],
    [y, truth.scale],
    [z, truth.scale],
  ] as const)
    assert.ok(Math.abs(length / expected - 1) < 0.02, `${length} for ${expected}`);
  const plain = await here.alignViews(input, { metrics: false });
  assert.deepEqual(plain.matrix, matrix);
  assert.equal(plain.proportions, undefined);
});

test("unknown cameras: one size, and camera poses that follow", async () => {
  const found = await here.alignViews(unknown);
  assert.equal(found.world, "camera");
  assert.ok(Math.abs(found.scale / truth.scale - 1) < 0.03, `scale ${found.scale}`);
  found.views.forEach((view, k) => {
    assert.ok(Math.abs(view.scale / found.scale - 1) < 1e-9, `view ${k}`);
    assert.ok(turnBetween(view.rotation, rig[k]?.pose.rotation ?? []) < 5, `view ${k}`);
    assert.ok(turnBetween(view.camera.rotation, rig[k]?.cameraToWorld.rotation ?? []) < 8, `camera ${k}`);
  });
});

test("a worker gives the same bits, also of a prepared mesh and with moved arrays", async () => {
  const expected = withoutTimes(await here.alignViews(known, { quality: "fast" }));
  assert.deepEqual(withoutTimes(await pool.alignViews(known, { quality: "fast" })), expected);
  using prepared = await pool.prepareMesh(mesh);
  assert.deepEqual(withoutTimes(await pool.alignViews({ ...known, mesh: prepared }, { quality: "fast" })), expected);
  const views = known.views.map((view) => structuredClone(view));
  const { input, ...moved } = await pool.alignViews(
    { mesh: structuredClone(mesh), views },
    { quality: "fast", transfer: true },
  );
  assert.deepEqual(withoutTimes(moved), expected);
  assert.equal((input?.views[2]?.depth as Float32Array | undefined)?.length, 160 * 120);
});

test("a view may lack a mask, a matrix may be the pose, and progress is reported", async () => {
  const stages = new Set<string>();
  const views = known.views.map((view, k) => (k === 1 ? { ...view, mask: undefined } : view));
  const found = await here.alignViews({ mesh, views }, { onProgress: ({ stage }) => stages.add(stage) });
  assert.equal(found.views[1]?.role, "used");
  assert.ok(stages.has("search"));
  // Without the sign of zeros.
  const matrix = found.views[0]?.camera.matrix.map((x) => x + 0);
  assert.deepEqual(matrix, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
});

test("a signal ends the call", async () => {
  const signal = AbortSignal.abort(new Error("enough"));
  await assert.rejects(() => here.alignViews(known, { signal }), /enough/);
});

test("what is refused names the view", async () => {
  const [first, second] = known.views as [ViewsInput["views"][number], ViewsInput["views"][number]];
  const cases: [unknown, Fault][] = [
    [{ mesh }, "INVALID_ARGUMENT views"],
    [{ mesh, views: [] }, "INVALID_ARGUMENT views"],
    [{ mesh, views: [first, { ...second, cameraToWorld: undefined }] }, "INVALID_ARGUMENT views"],
    [{ mesh, views: [first, { ...second, depht: 1 }] }, "INVALID_ARGUMENT views[1].depht"],
    [{ mesh, views: [first, { ...second, depth: [1, 2] }] }, "INVALID_ARGUMENT views[1].depth"],
    [{ mesh, views: [first, { ...second, mask: new Uint8Array(160 * 120) }] }, "EMPTY_MASK views[1].mask"],
    [
      { mesh, views: [{ ...first, cameraToWorld: { ...rig[0]?.cameraToWorld, scale: 2 } }] },
      "INVALID_TRANSFORM views[0].cameraToWorld",
    ],
    [{ mesh, views: [7] }, "INVALID_ARGUMENT views[0]"],
    [{ mesh, views: [first], depth: 1 }, "INVALID_ARGUMENT input.depth"],
  ];
  for (const [input, fault] of cases) await rejectsWith(() => here.alignViews(input as ViewsInput), fault);
  const options = { initial: null } as never;
  await rejectsWith(() => here.alignViews(known, options), "UNKNOWN_OPTION options.initial", /initial/);
  assert.equal(VIEWS_DEFAULTS.metrics, true);
});
