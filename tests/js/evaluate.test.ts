/** `evaluate` on poses whose score is known. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner, type EvaluateOptions, type Metrics } from "sim3align";
import { brick, columnMajor, input, product, truth } from "../support/scene.js";

const aligner = await createAligner();
const perfect = await aligner.evaluate(input, truth, { truth });

test("the truth scores as a perfect pose", () => {
  const { metrics, errors, warnings } = perfect;
  assert.ok((metrics.iou ?? 0) > 0.99 && (metrics.boundaryF ?? 0) > 0.99, JSON.stringify(metrics));
  assert.ok((metrics.centerDriftPx ?? 9) < 0.1 && (metrics.depthMaeM ?? 9) < 1e-5, JSON.stringify(metrics));
  assert.ok(errors !== null && errors.scaleError < 1e-9 && errors.rotationErrorDeg < 1e-3);
  assert.ok(errors.translationErrorM < 1e-9 && errors.addSM < 1e-6, JSON.stringify(errors));
  assert.deepEqual(warnings, []);
});

test("without a truth there are no errors", async () => {
  assert.equal((await aligner.evaluate(input, truth)).errors, null);
});

test("half turns of a brick are the same pose, unless it is declared to have no symmetry", async () => {
  const turned = { ...truth, rotation: product(truth.rotation, [0, 0, 1, 0]) };
  const errorOf = async (options: EvaluateOptions) =>
    (await aligner.evaluate(brick, turned, { truth, ...options })).errors?.rotationErrorDeg ?? Number.NaN;
  assert.ok((await errorOf({})) < 1e-3 && (await errorOf({ symmetry: "none" })) > 179);
});

/** Whether metrics are the same but for the rounding of a transform in another form. */
function assertSame(found: Metrics, expected: Metrics): void {
  for (const [name, value] of Object.entries(expected)) {
    const other = found[name as keyof Metrics];
    const tolerance = name.endsWith("M") ? 1e-9 : 1e-6;
    assert.ok(Math.abs((other ?? Number.NaN) - (value ?? Number.NaN)) < tolerance, `${name}: ${other}, not ${value}`);
  }
}

test("what align returned has its own metrics, and the truth as a matrix is the same truth", async () => {
  const matrix = columnMajor(truth);
  const { metrics, errors } = await aligner.evaluate(input, matrix, { truth: { matrix } });
  assertSame(metrics, perfect.metrics);
  assert.ok(errors !== null && errors.rotationErrorDeg < 1e-3);
  const alignment = await aligner.align(input, { quality: "fast" });
  assertSame((await aligner.evaluate(input, alignment)).metrics, alignment.metrics);
});
