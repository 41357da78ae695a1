/** Several views: known and unknown cameras, photos, with and without workers. */
import assert from "node:assert/strict";
import { after, test } from "node:test";
import { createAligner, type ViewInput, type ViewsInput } from "sim3align";
import { printedBox } from "../support/printed-box.js";
import { withoutTimes } from "../support/results.js";
import { frameAt, turnBetween } from "../support/rig.js";
import { mesh, truth } from "../support/scene.js";

const here = await createAligner();
const pool = await createAligner({ workers: 1 });
after(() => pool.dispose());

const quick = { quality: "fast" } as const;
const rig = [0, 120, 240].map((angle) => frameAt(angle));
const known: ViewsInput = { mesh, views: rig.map(({ frame, cameraToWorld }) => ({ ...frame, cameraToWorld })) };
const turnAt = (k: number, rotation: readonly number[]) => turnBetween(rotation, rig[k]?.pose.rotation ?? []);

test("known cameras: one pose in the world, and in each view; a view may lack a mask", async () => {
  const stages = new Set<string>();
  const onProgress = ({ stage }: { stage: string }) => stages.add(stage);
  const found = await here.alignViews(known, { onProgress });
  assert.ok(found.world === "given" && stages.has("search"));
  assert.ok(Math.abs(found.scale / truth.scale - 1) < 0.02, `scale ${found.scale}`);
  assert.ok(turnBetween(found.rotation, truth.rotation) < 3);
  for (const [k, view] of found.views.entries()) {
    assert.ok(view.role === "used" && turnAt(k, view.rotation) < 3, `view ${k}`);
    assert.ok((view.metrics?.iou ?? 0) > 0.8, `view ${k}`);
  }
  assert.ok(found.confidence > 0.5 && found.uncertainty !== null);
  const views = known.views.map((view, k) => (k === 1 ? { ...view, mask: undefined } : view));
  const unmasked = await here.alignViews({ mesh, views }, { ...quick, metrics: false });
  assert.equal(unmasked.views[1]?.role, "used");
  // Without the sign of zeros.
  const matrix = unmasked.views[0]?.camera.matrix.map((x) => x + 0);
  assert.deepEqual(matrix, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
  assert.ok(unmasked.views.every((view) => !("metrics" in view)));
});

test("unknown cameras: one size, and camera poses that follow", async () => {
  const found = await here.alignViews({ mesh, views: rig.map(({ frame }) => frame) });
  assert.equal(found.world, "camera");
  assert.ok(Math.abs(found.scale / truth.scale - 1) < 0.03, `scale ${found.scale}`);
  for (const [k, view] of found.views.entries()) {
    assert.ok(Math.abs(view.scale / found.scale - 1) < 1e-9 && turnAt(k, view.rotation) < 5, `view ${k}`);
    assert.ok(turnBetween(view.camera.rotation, rig[k]?.cameraToWorld.rotation ?? []) < 8, `camera ${k}`);
  }
});

test("a worker gives the same bits, also of a prepared mesh and with moved arrays", async () => {
  const expected = withoutTimes(await here.alignViews(known, quick));
  using prepared = await pool.prepareMesh(mesh);
  assert.deepEqual(withoutTimes(await pool.alignViews({ ...known, mesh: prepared }, quick)), expected);
  const moving = structuredClone(known);
  const { input, ...moved } = await pool.alignViews(moving, { ...quick, transfer: true });
  assert.deepEqual(withoutTimes(moved), expected);
  assert.equal((input?.views[2]?.depth as Float32Array | undefined)?.length, 160 * 120);
  await assert.rejects(() => pool.alignViews(known, { signal: AbortSignal.abort(new Error("enough")) }), /enough/);
});

const box = printedBox();
const seen = [0, 4, 8].map((degrees) => box.frameAt(degrees));

test("photos tell the turn that shape leaves open", async () => {
  const views: ViewInput[] = seen.map(({ frame, image, cameraToWorld }) => ({ ...frame, image, cameraToWorld }));
  const found = await here.alignViews({ mesh: box.mesh, views });
  for (const [k, { rotation, color, metrics }] of found.views.entries()) {
    assert.ok(turnBetween(rotation, seen[k]?.pose.rotation ?? []) < 3, `view ${k}`);
    assert.ok(color !== undefined && color.agreement > 0.6 && (color.margin ?? 0) > 0.1, JSON.stringify(color));
    assert.ok((metrics?.colorAgreement ?? 0) > 0.5);
  }
  using prepared = await pool.prepareMesh(box.mesh);
  assert.deepEqual((await pool.alignViews({ mesh: prepared, views })).matrix, found.matrix, "a prepared mesh");
});
