/** `align` as its callers see it: what it returns, determinism, progress, options, the life of an aligner. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { type Alignment, createAligner, type Progress } from "sim3align";
import { rejectsWith } from "../support/errors.js";
import { input } from "../support/scene.js";

const aligner = await createAligner();
const { timingsMs: _, ...reference } = await aligner.align(input, { seed: 3 });
const withoutTimes = ({ timingsMs: _, ...result }: Alignment) => result;

test("the transform comes in every promised form, all saying the same", async () => {
  const { scale, rotation, rotationMatrix, translation, matrix } = await aligner.align(input);
  assert.ok(scale > 0);
  assert.equal(rotation.length, 4);
  assert.ok(Math.abs(Math.hypot(...rotation) - 1) < 1e-12);
  assert.ok(rotation[3] >= 0);
  assert.ok(matrix instanceof Float64Array && matrix.length === 16);
  const [x, y, z, w] = rotation;
  const turned = [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)];
  for (const k of [0, 1, 2] as const) {
    assert.ok(Math.abs((turned[k] ?? 0) - rotationMatrix[k][0]) < 1e-9, "the first column of R is where R takes x");
    assert.ok(Math.abs((matrix[k] ?? 0) - scale * rotationMatrix[k][0]) < 1e-9, "columns come first");
    assert.equal(matrix[12 + k], translation[k]);
  }
  assert.deepEqual([matrix[3], matrix[7], matrix[11], matrix[15]], [0, 0, 0, 1]);
});

test("the report is complete", () => {
  const { metrics, counts } = reference;
  assert.equal(reference.preset, "paper");
  assert.equal(reference.seed, 3);
  assert.ok(reference.initialScale > 0);
  assert.ok(Math.abs(reference.scale / reference.initialScale - reference.scaleRatio) < 1e-9);
  assert.ok(reference.scaleRatio >= 0.5 && reference.scaleRatio <= 1.5, "the guard holds");
  assert.equal(reference.collapsed, false);
  assert.equal(typeof reference.clamped, "boolean");
  assert.equal(typeof reference.converged, "boolean");
  assert.ok(reference.residualM >= 0);
  const codes = reference.warnings.map(({ code }) => code);
  assert.deepEqual(codes, reference.converged ? [] : ["NOT_CONVERGED"]);
  const names = ["boundaryF", "centerDriftPx", "chamferMm", "depthMaeMm", "fitness", "iou", "normalConsistency"];
  assert.deepEqual(Object.keys(metrics).sort(), [...names, "uniChamferMm"]);
  for (const [name, value] of Object.entries(metrics)) assert.ok(value === null || value >= 0, `${name}: ${value}`);
  for (const name of ["boundaryF", "iou", "fitness", "normalConsistency"] as const) {
    assert.ok((metrics[name] ?? 0) <= 1, name);
  }
  for (const [name, count] of Object.entries(counts)) assert.ok(Number.isInteger(count) && count >= 0, name);
  assert.ok(counts.inliers <= counts.matches && counts.matches > 0);
});

test("the stages are timed, and the total is their sum", async () => {
  const { total, ...stages } = (await aligner.align(input)).timingsMs;
  const names = ["observe", "sample", "normals", "features", "matching", "ransac", "filter", "icp", "metrics"];
  assert.deepEqual(Object.keys(stages), names);
  const sum = Object.values(stages).reduce((a, b) => a + b, 0);
  assert.ok(total > 0 && Math.abs(total - sum) < 1e-6 * total + 1e-9, `${total} against ${sum}`);
});

test("the same input and seed give the same bits, on this aligner and on another", async () => {
  assert.deepEqual(withoutTimes(await aligner.align(input, { seed: 3 })), reference);
  const other = await createAligner();
  assert.deepEqual(withoutTimes(await other.align(input, { seed: 3 })), reference);
});

test("calls at once do not disturb each other", async () => {
  const results = await Promise.all([3, 4, 3].map((seed) => aligner.align(input, { seed })));
  const [first, second, third] = results.map(withoutTimes);
  assert.deepEqual(first, reference);
  assert.deepEqual(third, reference);
  assert.equal(second?.seed, 4);
});

test("the arguments are left as they were", async () => {
  const { depth, mask, mesh } = input;
  const before = [depth.slice(), mask.slice(), mesh.positions.slice(), mesh.indices.slice()];
  await aligner.align(input);
  assert.deepEqual([depth, mask, mesh.positions, mesh.indices], before);
});

test("the guard rejects or clamps, and counts what it did", async () => {
  const narrow = { guard: [0.999, 1.001] as [number, number], ransacIterations: 5000 };
  const clamping = await aligner.align(input, { ...narrow, guardMode: "clamp" });
  assert.ok(clamping.counts.clamped > 0);
  assert.equal(clamping.counts.rejected, 0);
  assert.ok(clamping.scaleRatio >= 0.999 - 1e-9 && clamping.scaleRatio <= 1.001 + 1e-9, `${clamping.scaleRatio}`);
  const unguarded = await aligner.align(input, { guard: null });
  assert.equal(unguarded.counts.rejected + unguarded.counts.clamped, 0);
});

test("the ablations run", async () => {
  for (const options of [{ lockScale: false }, { hallucinationFilter: false }, { icp: "point-to-point" }] as const) {
    const { metrics } = await aligner.align(input, options);
    assert.ok(metrics.iou !== null, JSON.stringify(options));
  }
  const unrefined = await aligner.align(input, { icp: "none" });
  assert.equal(unrefined.counts.icpIterations, 0);
});

test("progress names the stages in order, and never falls", async () => {
  const seen: Progress[] = [];
  await aligner.align(input, { onProgress: (progress) => seen.push(progress) });
  assert.equal(seen[0]?.stage, "observe");
  assert.equal(seen[0]?.fraction, 0);
  assert.equal(seen.at(-1)?.fraction, 1);
  const stages = [...new Set(seen.map(({ stage }) => stage))];
  assert.deepEqual(stages.slice(0, 3), ["observe", "sample", "normals"]);
  seen.reduce((before, { fraction }) => {
    assert.ok(fraction >= before, `${fraction} after ${before}`);
    return fraction;
  }, 0);
});

test("what onProgress throws rejects the call, and leaves the aligner usable", async () => {
  const failure = new Error("stop");
  let calls = 0;
  const onProgress = () => {
    calls += 1;
    throw failure;
  };
  await assert.rejects(aligner.align(input, { onProgress }), (error) => error === failure);
  assert.equal(calls, 1, "it is not called again");
  assert.deepEqual(withoutTimes(await aligner.align(input, { seed: 3 })), reference);
});

test("options left undefined take their defaults", async () => {
  const options = { seed: 3, guard: undefined, onProgress: undefined } as unknown as { seed: number };
  assert.deepEqual(withoutTimes(await aligner.align(input, options)), reference);
});

test("the defaults are those of the documentation, and passing them changes nothing", async () => {
  const { align } = await aligner.defaults();
  assert.deepEqual(align.guard, [0.5, 1.5]);
  assert.equal(align.preset, "paper");
  assert.equal(align.voxelDivisions, 30);
  assert.deepEqual(withoutTimes(await aligner.align(input, { ...align, seed: 3 })), reference);
});

test("the result survives JSON", () => {
  const { matrix, ...plain } = reference;
  assert.deepEqual(JSON.parse(JSON.stringify(plain)), plain);
  assert.equal(Array.from(matrix).length, 16);
});

test("a disposed aligner says so, and others go on", async () => {
  const expected = { code: "DISPOSED", argument: "aligner", message: /createAligner\(\)/ } as const;
  const disposed = await createAligner();
  disposed.dispose();
  await rejectsWith(() => disposed.align(input), expected);
  await rejectsWith(() => disposed.evaluate(input, reference), expected);
  await rejectsWith(() => disposed.register(new Float32Array(99), new Float32Array(99)), expected);
  await rejectsWith(() => disposed.defaults(), expected);
  disposed.dispose();
  assert.deepEqual(withoutTimes(await aligner.align(input, { seed: 3 })), reference);
});

test("an aligner can be disposed of by a using declaration's symbol", async () => {
  const other = await createAligner();
  other[Symbol.dispose]();
  await assert.rejects(other.buildInfo(), { code: "DISPOSED" });
});
