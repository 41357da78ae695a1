/** `register` and `estimateSim3` find a similarity that is known. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner } from "sim3align";
import { assertForms } from "../support/results.js";
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

test("register finds scale, rotation and translation, with the same bits by its defaults; estimateSim3 the same scale", async () => {
  const result = await aligner.register(source, target);
  assertForms(result);
  assert.ok(Math.abs(result.scale / pose.scale - 1) < 1e-4, `scale ${result.scale}`);
  assert.ok(turnBetween(result.rotation, pose.rotation) < 6e-3, `${result.rotation}`);
  const far = Math.hypot(...result.translation.map((x, i) => x - (pose.translation[i] ?? 0)));
  assert.ok(far < 1e-3, `translation ${result.translation}`);
  assert.ok(result.fitness > 0.99 && result.diagnostics.converged, `${result.fitness}`);
  assert.ok(result.diagnostics.scaleRatio > 0.2 && result.diagnostics.scaleRatio < 5);
  const pairs = Uint32Array.from({ length: 200 }, (_, i) => i >> 1);
  const estimated = await aligner.estimateSim3(mesh.positions, target, pairs, { inlierDistance: 0.01 });
  assert.ok(Math.abs(estimated.scale / pose.scale - 1) < 1e-5, `scale ${estimated.scale}`);
  assert.deepEqual([estimated.diagnostics.counts.matches, estimated.fitness], [100, 1]);
});
