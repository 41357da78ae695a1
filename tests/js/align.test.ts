/** `align` as its callers see it: what it returns, determinism, progress, the life of an aligner. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { ALIGN_DEFAULTS, createAligner, PAPER_DEFAULTS, type Progress } from "sim3align";
import { codesOf, rejectsWith } from "../support/errors.js";
import { assertForms, withoutTimes } from "../support/results.js";
import { brick, input } from "../support/scene.js";

const aligner = await createAligner();
const reference = withoutTimes(await aligner.align(input, { seed: 3 }));
const paper = { preset: "paper" } as const;

test("the transform comes in every promised form, all saying the same", async () => {
  assertForms(reference);
  assertForms(await aligner.align(input, { preset: "paper" }));
});

test("the alternatives are transforms too, in the same forms", async () => {
  // A brick looks the same after half a turn, which no symmetry is declared to be.
  const { alternatives, matrix, diagnostics } = await aligner.align(brick, { symmetry: "none" });
  const { score } = diagnostics;
  assert.ok(alternatives.length > 0);
  for (const alternative of alternatives) {
    assertForms(alternative);
    assert.ok(alternative.score <= score, `${alternative.score} above ${score}`);
    assert.ok(alternative.turnDeg >= 0 && alternative.turnDeg <= 180, `${alternative.turnDeg}`);
    assert.notDeepEqual(alternative.matrix, matrix);
  }
  const scores = alternatives.map((alternative) => alternative.score);
  assert.deepEqual(
    scores,
    [...scores].sort((a, b) => b - a),
    "best first",
  );
});

test("the report is complete", () => {
  const { metrics, diagnostics, confidence, uncertainty } = reference;
  const { counts, terms } = diagnostics;
  assert.equal(diagnostics.preset, "precise");
  assert.equal(diagnostics.seed, 3);
  assert.ok(diagnostics.initialScale > 0);
  assert.ok(Math.abs(reference.scale / diagnostics.initialScale - diagnostics.scaleRatio) < 1e-9);
  assert.equal(diagnostics.collapsed, false);
  assert.ok(confidence >= 0 && confidence <= 1, `confidence ${confidence}`);
  assert.ok(diagnostics.score > 0);
  assert.deepEqual(Object.keys(terms).sort(), ["coverage", "depth", "hidden", "normals", "outline", "overlap"]);
  assert.ok(Array.isArray(reference.alternatives));
  if (uncertainty !== null) {
    const { rotationAxis, freeAxis, ...deviations } = uncertainty;
    assert.ok(freeAxis === null || Math.abs(Math.hypot(...freeAxis) - 1) < 1e-6, `${freeAxis}`);
    assert.deepEqual(Object.keys(deviations).sort(), ["distanceM", "lateralM", "rotationDeg", "scale"]);
    for (const [name, value] of Object.entries(deviations)) assert.ok(value >= 0, `${name}: ${value}`);
    assert.ok(Math.abs(Math.hypot(...rotationAxis) - 1) < 1e-6, `${rotationAxis}`);
  }
  assert.equal(typeof diagnostics.clamped, "boolean");
  assert.equal(typeof diagnostics.converged, "boolean");
  assert.ok(diagnostics.residualM >= 0);
  const codes = codesOf(reference.warnings);
  assert.deepEqual(codes, []);
  const names = ["boundaryF", "centerDriftPx", "chamferMm", "depthMaeMm", "fitness", "iou", "normalConsistency"];
  assert.deepEqual(Object.keys(metrics).sort(), [...names, "uniChamferMm"]);
  for (const [name, value] of Object.entries(metrics)) assert.ok(value === null || value >= 0, `${name}: ${value}`);
  for (const name of ["boundaryF", "iou", "fitness", "normalConsistency"] as const) {
    assert.ok((metrics[name] ?? 0) <= 1, name);
  }
  for (const [name, count] of Object.entries(counts)) assert.ok(Number.isInteger(count) && count >= 0, name);
  assert.ok(counts.renders > 0);
});

test("the paper's method is there by its name", async () => {
  const result = await aligner.align(input, { preset: "paper" });
  const { preset, scaleRatio, counts, timingsMs } = result.diagnostics;
  assert.equal(preset, "paper");
  assert.ok(scaleRatio >= 0.5 && scaleRatio <= 1.5, "the guard holds");
  for (const name of ["confidence", "alternatives", "uncertainty"]) assert.ok(!(name in result), name);
  for (const name of ["score", "terms"]) assert.ok(!(name in result.diagnostics), name);
  assert.ok(counts.inliers <= counts.matches && counts.matches > 0);
  assert.ok(!("renders" in counts));
  const names = ["observe", "sample", "normals", "features", "matching", "ransac", "filter", "icp", "metrics", "total"];
  assert.deepEqual(Object.keys(timingsMs), names);
});

test("the stages are timed, and the total is their sum", async () => {
  const { total, ...stages } = (await aligner.align(input)).diagnostics.timingsMs;
  for (const name of ["observe", "prepare", "search", "refine", "metrics"]) assert.ok(name in stages, name);
  const sum = Object.values(stages).reduce((a, b) => a + b, 0);
  assert.ok(total > 0 && Math.abs(total - sum) < 1e-6 * total + 1e-9, `${total} against ${sum}`);
});

test("the arguments are left as they were", async () => {
  const { depth, mask, mesh } = input;
  const before = [depth.slice(), mask.slice(), mesh.positions.slice(), mesh.indices.slice()];
  await aligner.align(input);
  assert.deepEqual([depth, mask, mesh.positions, mesh.indices], before);
});

test("the guard rejects or clamps, and counts what it did", async () => {
  const narrow = { ...paper, guard: [0.999, 1.001] as [number, number], ransacIterations: 5000 };
  const { diagnostics: clamping } = await aligner.align(input, { ...narrow, guardMode: "clamp" });
  assert.ok(clamping.counts.clamped > 0);
  assert.equal(clamping.counts.rejected, 0);
  assert.ok(clamping.scaleRatio >= 0.999 - 1e-9 && clamping.scaleRatio <= 1.001 + 1e-9, `${clamping.scaleRatio}`);
  const { diagnostics: unguarded } = await aligner.align(input, { ...paper, guard: null });
  assert.equal(unguarded.counts.rejected + unguarded.counts.clamped, 0);
});

test("the ablations change what they are about", async () => {
  const whole = await aligner.align(input, paper);
  const unrefined = await aligner.align(input, { ...paper, icp: "none" });
  assert.equal(unrefined.diagnostics.counts.icpIterations, 0);
  assert.ok(Math.abs(unrefined.scale / whole.scale - 1) < 1e-12, "ICP leaves the scale alone");
  assert.notDeepEqual(unrefined.translation, whole.translation);
  const unlocked = await aligner.align(input, { ...paper, lockScale: false });
  assert.notEqual(unlocked.scale, whole.scale, "unlocked, it does not");
  const toPoints = await aligner.align(input, { ...paper, icp: "point-to-point" });
  assert.notDeepEqual(toPoints.translation, whole.translation);
  const unfiltered = await aligner.align(input, { ...paper, hallucinationFilter: false });
  assert.ok(unfiltered.diagnostics.counts.supported > whole.diagnostics.counts.supported);
});

test("metrics are left out on request, and nothing else changes", async () => {
  const { metrics, ...others } = reference;
  const without = await aligner.align(input, { seed: 3, metrics: false });
  assert.ok(metrics.iou !== null && !("metrics" in without));
  assert.ok(!("metrics" in without.diagnostics.timingsMs) && !("normals" in without.diagnostics.timingsMs));
  const { timingsMs: _, ...diagnostics } = without.diagnostics;
  assert.deepEqual({ ...without, diagnostics }, others);
  const baseline = await aligner.align(input, { preset: "paper", metrics: false });
  assert.ok(!("metrics" in baseline) && baseline.scale > 0);
});

test("progress names the stages in order, and never falls", async () => {
  const seen: Progress[] = [];
  await aligner.align(input, { onProgress: (progress) => seen.push(progress) });
  assert.equal(seen[0]?.stage, "observe");
  assert.equal(seen[0]?.fraction, 0);
  assert.equal(seen.at(-1)?.fraction, 1);
  const last = seen.at(-1)?.best;
  assert.ok(Array.isArray(last?.matrix) && last.matrix.length === 16);
  const stages = [...new Set(seen.map(({ stage }) => stage))];
  assert.deepEqual(stages.slice(0, 2), ["observe", "sample"]);
  assert.ok(stages.indexOf("search") > 0 && stages.indexOf("search") < stages.indexOf("refine"), `${stages}`);
  seen.reduce((before, { fraction }) => {
    assert.ok(fraction >= before, `${fraction} after ${before}`);
    return fraction;
  }, 0);
});

test("options left undefined take their defaults", async () => {
  const options = { seed: 3, quality: undefined, onProgress: undefined };
  assert.deepEqual(withoutTimes(await aligner.align(input, options)), reference);
});

test("the defaults are those of the documentation, and passing them changes nothing", async () => {
  assert.equal(ALIGN_DEFAULTS.symmetry, "auto");
  assert.deepEqual(PAPER_DEFAULTS.guard, [0.5, 1.5]);
  assert.deepEqual(withoutTimes(await aligner.align(input, { ...ALIGN_DEFAULTS, seed: 3 })), reference);
  const [plain, spelt] = [await aligner.align(input, paper), await aligner.align(input, PAPER_DEFAULTS)];
  assert.deepEqual([spelt.matrix, spelt.metrics], [plain.matrix, plain.metrics]);
});

test("the result survives JSON", () => {
  assert.deepEqual(JSON.parse(JSON.stringify(reference)), reference);
});

test("a disposed aligner says so, and others go on", async () => {
  const expected = ["DISPOSED aligner", /createAligner\(\)/] as const;
  const disposed = await createAligner();
  disposed.dispose();
  await rejectsWith(() => disposed.align(input), ...expected);
  await rejectsWith(() => disposed.evaluate(input, reference), ...expected);
  await rejectsWith(() => disposed.register(new Float32Array(99), new Float32Array(99)), ...expected);
  disposed.dispose();
  assert.deepEqual(withoutTimes(await aligner.align(input, { seed: 3 })), reference);
});

test("an aligner can be disposed of by a using declaration's symbol", async () => {
  const other = await createAligner();
  other[Symbol.dispose]();
  await assert.rejects(other.align(input), { code: "DISPOSED" });
});
