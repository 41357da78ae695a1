/** `align` as its callers see it: the form of a result, repeatability, progress, the life of an aligner. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner } from "sim3align";
import { codesOf, rejectsWith } from "../support/errors.js";
import { assertForms, withoutTimes } from "../support/results.js";
import { brick, input } from "../support/scene.js";

const aligner = await createAligner();
const quick = { quality: "fast" } as const;
const paper = { preset: "paper" } as const;
const reference = withoutTimes(await aligner.align(input, { seed: 3 }));
const baseline = await aligner.align(input, paper);

test("a result has every promised part, in its range, and survives JSON", () => {
  assertForms(reference);
  const { metrics, diagnostics, confidence, uncertainty } = reference;
  assert.deepEqual([diagnostics.preset, diagnostics.seed, diagnostics.collapsed], ["precise", 3, false]);
  assert.ok(Math.abs(reference.scale / diagnostics.initialScale - diagnostics.scaleRatio) < 1e-9);
  assert.ok(confidence > 0.5 && confidence <= 1, `confidence ${confidence}`);
  assert.ok(diagnostics.score > 0 && diagnostics.residualM >= 0);
  const terms = ["coverage", "depth", "hidden", "normals", "outline", "overlap"];
  assert.deepEqual(Object.keys(diagnostics.terms).sort(), terms);
  assert.ok(uncertainty !== null);
  const { rotationAxis, freeAxis, ...deviations } = uncertainty;
  for (const axis of [rotationAxis, freeAxis ?? rotationAxis]) assert.ok(Math.abs(Math.hypot(...axis) - 1) < 1e-6);
  assert.deepEqual(Object.keys(deviations).sort(), ["distanceM", "lateralM", "rotationDeg", "scale"]);
  for (const [name, value] of Object.entries(deviations)) assert.ok(value >= 0, `${name}: ${value}`);
  assert.deepEqual(codesOf(reference.warnings), []);
  const names = ["boundaryF", "centerDriftPx", "chamferM", "depthMaeM", "fitness", "iou", "normalConsistency"];
  assert.deepEqual(Object.keys(metrics).sort(), [...names, "uniChamferM"]);
  for (const name of ["boundaryF", "iou", "fitness", "normalConsistency"] as const) {
    assert.ok((metrics[name] ?? 0) > 0.8 && (metrics[name] ?? 2) <= 1, name);
  }
  for (const [name, count] of Object.entries(diagnostics.counts))
    assert.ok(Number.isInteger(count) && count >= 0, name);
  assert.deepEqual(JSON.parse(JSON.stringify(reference)), reference);
});

test("the symmetry in a result is an option that gives the same result", async () => {
  const aligner = await createAligner();
  const found = await aligner.align(brick, quick);
  assert.deepEqual(
    found.symmetry.map(({ fold }) => fold),
    [2, 2],
  );
  const { diagnostics: _, ...again } = await aligner.align(brick, { ...quick, symmetry: found.symmetry });
  const { diagnostics: __, ...first } = found;
  assert.deepEqual(again, first);
  assert.deepEqual((await aligner.align(brick, { ...quick, symmetry: "none" })).symmetry, []);
});

test("alternatives are transforms in the same forms, best first", async () => {
  // A brick looks the same after half a turn, which no symmetry is declared to be.
  const { alternatives, matrix, diagnostics } = await aligner.align(brick, { ...quick, symmetry: "none" });
  assert.ok(alternatives.some(({ turnDeg }) => turnDeg > 170));
  for (const [i, alternative] of alternatives.entries()) {
    assertForms(alternative);
    const before = alternatives[i - 1]?.score ?? diagnostics.score;
    assert.ok(alternative.score <= before, `${alternative.score} after ${before}`);
    assert.notDeepEqual(alternative.matrix, matrix);
  }
});

test("the paper's method has its own report", () => {
  assertForms(baseline);
  const { preset, scaleRatio, counts, timingsMs } = baseline.diagnostics;
  assert.equal(preset, "paper");
  assert.ok(scaleRatio >= 0.5 && scaleRatio <= 1.5, "the guard holds");
  for (const name of ["confidence", "alternatives", "uncertainty"]) assert.ok(!(name in baseline), name);
  for (const name of ["score", "terms"]) assert.ok(!(name in baseline.diagnostics), name);
  assert.ok(counts.inliers <= counts.matches && counts.matches > 0 && !("renders" in counts));
  const names = ["observe", "sample", "normals", "features", "matching", "ransac", "filter", "icp", "metrics", "total"];
  assert.deepEqual(Object.keys(timingsMs), names);
});

test("the stages are timed, and the total is their sum", async () => {
  const { total, ...stages } = (await aligner.align(input, quick)).diagnostics.timingsMs;
  for (const name of ["observe", "prepare", "search", "refine", "metrics"]) assert.ok(name in stages, name);
  const sum = Object.values(stages).reduce((a, b) => a + b, 0);
  assert.ok(total > 0 && Math.abs(total - sum) < 1e-6 * total + 1e-9, `${total} against ${sum}`);
});

test("an option that is undefined is left out", async () => {
  const options = { seed: 3, quality: undefined, onProgress: undefined };
  assert.deepEqual(withoutTimes(await aligner.align(input, options)), reference);
});

test("the same call gives the same bits, after other calls and errors and in another instance; arguments stay", async () => {
  const { depth, mask, mesh } = input;
  const before = structuredClone([depth, mask, mesh.positions, mesh.indices]);
  await assert.rejects(aligner.align(input, { search: "local" }), { code: "INVALID_OPTION" });
  for (const other of [aligner, await createAligner()]) {
    assert.deepEqual(withoutTimes(await other.align(input, { seed: 3 })), reference);
  }
  assert.deepEqual([depth, mask, mesh.positions, mesh.indices], before);
});

test("a mesh whose arrays were changed in place is another one", async () => {
  const positions = Float32Array.from(input.mesh.positions);
  const call = { ...input, mesh: { ...input.mesh, positions } };
  const { scale } = await aligner.align(call, quick);
  positions.forEach((x, i) => {
    positions[i] = 2 * x;
  });
  const again = await aligner.align(call, quick);
  assert.deepEqual(withoutTimes(again), withoutTimes(await (await createAligner()).align(call, quick)));
  assert.ok(Math.abs((2 * again.scale) / scale - 1) < 0.01, `${scale} -> ${again.scale}`);
});

test("a disposed aligner says so, and others go on", async () => {
  const disposed = await createAligner();
  const cloud = new Float32Array(99);
  disposed.dispose();
  for (const call of [
    () => disposed.align(input),
    () => disposed.evaluate(input, reference),
    () => disposed.register(cloud, cloud),
  ])
    await rejectsWith(call, "DISPOSED aligner", /createAligner\(\)/);
  disposed.dispose();
  const other = await createAligner();
  other[Symbol.dispose]();
  await rejectsWith(() => other.align(input), "DISPOSED aligner");
  assert.deepEqual(withoutTimes(await aligner.align(input, { seed: 3 })), reference);
});
