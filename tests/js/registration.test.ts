/** `register` and `estimateSim3` find similarities that are known. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner, ESTIMATE_SIM3_DEFAULTS, REGISTER_DEFAULTS, type Registration } from "sim3align";
import { Random } from "../support/random.js";
import { assertForms, withoutTimes } from "../support/results.js";
import { turnBetween } from "../support/rig.js";
import { mesh, type Pose, transformed } from "../support/scene.js";

const aligner = await createAligner();
const source = Float64Array.from(mesh.positions);
const length = Math.hypot(0.5, -0.5, 0.1, 0.7);
const pose: Pose = {
  scale: 2.5,
  rotation: [0.5 / length, -0.5 / length, 0.1 / length, 0.7 / length],
  translation: [30, -20, 10],
};
const target = transformed(source, pose);

function assertPose(found: Registration, tolerance: number, expected = pose): void {
  assertForms(found);
  assert.ok(Math.abs(found.scale / expected.scale - 1) < tolerance, `scale ${found.scale}`);
  assert.ok(turnBetween(found.rotation, expected.rotation) < 60 * Math.max(tolerance, 1e-6), `${found.rotation}`);
  const far = Math.hypot(...found.translation.map((x, i) => x - (expected.translation[i] ?? 0)));
  assert.ok(far < 10 * tolerance, `translation ${found.translation}`);
}

test("register finds scale, rotation and translation of a cloud, with the same bits twice and by its defaults", async () => {
  const result = await aligner.register(source, target);
  assertPose(result, 1e-4);
  assert.ok(result.fitness > 0.99 && result.diagnostics.converged, `${result.fitness}`);
  assert.ok(result.diagnostics.scaleRatio > 0.2 && result.diagnostics.scaleRatio < 5);
  assert.deepEqual(withoutTimes(await aligner.register(source, target, REGISTER_DEFAULTS)), withoutTimes(result));
  assertPose(await aligner.register(mesh.positions, target, { seed: 9 }), 1e-4);
});

test("estimateSim3 finds what correct correspondences agree on, among wrong ones", async () => {
  const count = 300;
  const random = new Random(7);
  const correspondences = new Uint32Array(2 * count);
  for (let i = 0; i < count; i++) {
    const [index, other] = [0, 0].map(() => random.whole(0, source.length / 3 - 1)) as [number, number];
    correspondences.set([index, i % 2 === 0 ? index : other], 2 * i);
  }
  const result = await aligner.estimateSim3(source, target, correspondences, { inlierDistance: 0.01 });
  assertPose(result, 1e-5);
  const defaults = { ...ESTIMATE_SIM3_DEFAULTS, inlierDistance: 0.01 };
  const again = await aligner.estimateSim3(source, target, correspondences, defaults);
  assert.deepEqual(again.matrix, result.matrix);
  const { counts } = result.diagnostics;
  assert.ok(counts.matches === count && counts.inliers >= count / 2, `${counts.inliers}`);
  assert.ok(Math.abs(result.fitness - counts.inliers / count) < 1e-9);
});
