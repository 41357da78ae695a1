/** `evaluate` on poses whose score is known. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner, EVALUATE_DEFAULTS, type EvaluateOptions, type Sim3Like } from "sim3align";
import { type Refusals, refuses } from "../support/errors.js";
import { assertSameMetrics } from "../support/metrics.js";
import { columnMajor, input, rotationRows, truth } from "../support/scene.js";

const aligner = await createAligner();
const turned = (degrees: number): Sim3Like => {
  const half = (degrees * Math.PI) / 360;
  const [x, y, z, w] = truth.rotation;
  // About the mesh's z: q · (0, 0, sin, cos).
  const [s, c] = [Math.sin(half), Math.cos(half)];
  return { ...truth, rotation: [x * c + y * s, y * c - x * s, z * c + w * s, w * c - z * s] };
};

test("the truth scores as a perfect pose", async () => {
  const { metrics, errors, warnings, diagnostics } = await aligner.evaluate(input, truth, { truth });
  const { scaleRatio, collapsed } = diagnostics;
  assert.ok((metrics.iou ?? 0) > 0.99, `iou ${metrics.iou}`);
  assert.ok((metrics.boundaryF ?? 0) > 0.99, `boundaryF ${metrics.boundaryF}`);
  assert.ok((metrics.centerDriftPx ?? 9) < 0.1, `centerDriftPx ${metrics.centerDriftPx}`);
  assert.ok((metrics.uniChamferMm ?? 9) < 0.1, `uniChamferMm ${metrics.uniChamferMm}`);
  assert.equal(metrics.fitness, 1);
  assert.ok((metrics.normalConsistency ?? 0) > 0.97, `normalConsistency ${metrics.normalConsistency}`);
  assert.ok((metrics.depthMaeMm ?? 9) < 0.01, `depthMaeMm ${metrics.depthMaeMm}`);
  assert.ok((metrics.chamferMm ?? 0) > 1, "the unseen side counts");
  assert.ok(errors !== null);
  assert.ok(errors.scaleError < 1e-9 && errors.rotationErrorDeg < 1e-3 && errors.translationErrorM < 1e-9);
  assert.ok(errors.addSMm < 1e-3, `addSMm ${errors.addSMm}`);
  assert.ok(scaleRatio > 0.5 && scaleRatio < 1.5);
  assert.equal(collapsed, false);
  assert.deepEqual(warnings, []);
});

test("a wrong pose has the errors that were put into it", async () => {
  const off = {
    ...truth,
    scale: 1.1 * truth.scale,
    rotation: (turned(20) as typeof truth).rotation,
  };
  const { metrics, errors } = await aligner.evaluate(input, off, { truth });
  assert.ok(errors !== null);
  assert.ok(Math.abs(errors.scaleError - 0.1) < 1e-9, `${errors.scaleError}`);
  assert.ok(Math.abs(errors.rotationErrorDeg - 20) < 1e-6, `${errors.rotationErrorDeg}`);
  const perfect = await aligner.evaluate(input, truth);
  assert.ok((metrics.iou ?? 1) < (perfect.metrics.iou ?? 0));
  assert.ok((metrics.depthMaeMm ?? 0) > (perfect.metrics.depthMaeMm ?? 0));
});

test("layout says how well the object occupies its place", async () => {
  const perfect = (await aligner.evaluate(input, truth, { truth })).layout;
  assert.ok(perfect?.isFound && perfect.isCadAligned);
  assert.ok(Math.abs(perfect.boxIou - 1) < 1e-9 && perfect.icpRotationDeg < 0.01 && perfect.addSRelative < 1e-5);
  // ICP undoes the turn; the box and the surface are off by it.
  const { layout, errors } = await aligner.evaluate(input, turned(15), { truth });
  assert.ok(layout !== null && errors !== null);
  assert.ok(Math.abs(layout.icpRotationDeg - 15) < 0.5, `icpRotationDeg ${layout.icpRotationDeg}`);
  assert.ok(layout.boxIou > 0.4 && layout.boxIou < 0.95 && layout.isFound && layout.isCadAligned);
  // 28 cm aside, nothing is in common.
  const away = await aligner.evaluate(input, { ...truth, translation: [0.3, 0, 0.7] }, { truth });
  assert.ok(away.layout !== null);
  assert.deepEqual([away.layout.boxIou, away.layout.isFound, away.layout.isCadAligned], [0, false, false]);
  assert.equal((await aligner.evaluate(input, truth)).layout, null);
  const without = await aligner.evaluate(input, turned(15), { truth, layout: false });
  assert.equal(without.layout, null);
  assert.deepEqual(without.errors, errors);
});

test("all forms of a transform are the same transform", async () => {
  const reference = await aligner.evaluate(input, truth, { truth });
  const rows = rotationRows(truth.rotation);
  const matrix = columnMajor(truth);
  const forms: Sim3Like[] = [
    matrix,
    Float64Array.from(matrix),
    { matrix },
    { matrix: Float64Array.from(matrix) },
    { ...truth, rotation: rows },
    { ...truth, rotation: rows.flat() },
    { ...truth, rotation: Float64Array.from(truth.rotation), translation: Float64Array.from(truth.translation) },
  ];
  for (const form of forms) {
    const { metrics, errors } = await aligner.evaluate(input, form, { truth: form });
    for (const [name, value] of Object.entries(reference.metrics)) {
      const found = metrics[name as keyof typeof metrics] ?? Number.NaN;
      assert.ok(Math.abs(found - (value ?? Number.NaN)) < 1e-6, `${name}: ${found}, not ${value}`);
    }
    assert.ok(errors !== null && errors.rotationErrorDeg < 1e-3);
  }
});

test("an alignment is a transform, and scores as align said", async () => {
  const alignment = await aligner.align(input);
  assertSameMetrics((await aligner.evaluate(input, alignment)).metrics, alignment.metrics);
});

test("the defaults passed as options change nothing", async () => {
  const [plain, spelt] = [
    await aligner.evaluate(input, truth),
    await aligner.evaluate(input, truth, EVALUATE_DEFAULTS),
  ];
  assert.deepEqual(spelt, plain);
});

test("declared symmetries are no errors", async () => {
  const half = turned(180);
  const rotationError = async (options: EvaluateOptions) => {
    const { errors } = await aligner.evaluate(input, half, { truth, ...options });
    return errors?.rotationErrorDeg ?? Number.NaN;
  };
  assert.ok(Math.abs((await rotationError({})) - 180) < 1e-3);
  assert.ok(Math.abs((await rotationError({ symmetry: "none" })) - 180) < 1e-3);
  assert.ok(Math.abs((await rotationError({ symmetry: "auto" })) - 180) < 1e-3, "the blob has none of its own");
  assert.ok((await rotationError({ symmetry: [{ axis: [0, 0, 1], fold: 2 }] })) < 1e-3);
  assert.ok((await rotationError({ symmetry: [{ axis: [0, 0, 3] }] })) < 1e-3);
  assert.ok((await rotationError({ symmetry: [{ axis: [0, 0, 1], fold: undefined }] })) < 1e-3);
  assert.ok((await rotationError({ symmetry: [{ axis: [0, 0, 1], fold: 3 }] })) > 50);
});

test("where nothing overlaps, there is null and no flattering number", async () => {
  const behind = { ...truth, translation: [0, 0, -2] };
  const { metrics, errors } = await aligner.evaluate(input, behind);
  assert.equal(metrics.iou, 0);
  assert.equal(metrics.centerDriftPx, null);
  assert.equal(metrics.depthMaeMm, null);
  assert.equal(metrics.fitness, 0);
  assert.equal(errors, null, "no truth, no errors");
});

test("a collapsed scale is called so", async () => {
  const { diagnostics } = await aligner.evaluate(input, { ...truth, scale: 0.01 });
  const { collapsed, scaleRatio } = diagnostics;
  assert.ok(scaleRatio < 0.3);
  assert.equal(collapsed, true);
});

const badTransforms: Refusals<unknown> = {
  "nothing: INVALID_ARGUMENT transform": [undefined, /transform/],
  "a scale of zero: INVALID_TRANSFORM transform": [{ ...truth, scale: 0 }, /scale/],
  "a negative scale: INVALID_TRANSFORM transform": [{ ...truth, scale: -1 }, /scale/],
  "a NaN: INVALID_TRANSFORM transform": [{ ...truth, translation: [0, Number.NaN, 0] }, /finite|NaN/],
  "a reflection: INVALID_TRANSFORM transform": [
    { ...truth, rotation: [1, 0, 0, 0, 1, 0, 0, 0, -1] },
    /reflection|rotation/,
  ],
  "a row-major matrix: INVALID_TRANSFORM transform.matrix": [
    [0.1, 0, 0, 1, 0, 0.1, 0, 2, 0, 0, 0.1, 3, 0, 0, 0, 1],
    /column-major/,
  ],
};

refuses(badTransforms, (transform) => aligner.evaluate(input, transform as Sim3Like));

test("after all that, the aligner works on", async () => {
  assert.ok((await aligner.evaluate(input, truth)).metrics.iou);
});
