/** The options of `precise`: what is accepted, and that every answer is a similarity. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { type Alignment, type AlignOptions, createAligner, type Sim3Like } from "sim3align";
import { assertForms, withoutTimes } from "../support/results.js";
import { brick, columnMajor, input, rotationRows, truth } from "../support/scene.js";

const aligner = await createAligner();
const quick = { quality: "fast" } as const;

/** The blob's extent along its axes, in mesh units. */
const extent = ([0, 1, 2] as const).map((axis) => {
  const along = input.mesh.positions.filter((_, i) => i % 3 === axis);
  return Math.max(...along) - Math.min(...along);
});
const plain = await aligner.align(input, quick);
const worse = { ...truth, scale: 0.9 * truth.scale };
const near = (a: number, b: number) => Math.abs(a / b - 1) < 1e-6;

type Check = (found: Alignment) => boolean;
const effects: readonly [options: AlignOptions & { metrics?: true }, check: Check][] = [
  [{ quality: "balanced" }, (found) => found.diagnostics.counts.renders > plain.diagnostics.counts.renders],
  [{ quality: "best", workBudget: 100 }, (found) => found.diagnostics.effort === "best"],
  [{ scale: 0.9 * truth.scale }, (found) => near(found.scale, 0.9 * truth.scale)],
  [{ scale: [0.05, 0.2] }, (found) => near(found.scale, plain.scale) && !found.diagnostics.clamped],
  [{ scale: [1.1 * truth.scale, 1] }, (found) => found.scale >= 1.1 * truth.scale - 1e-9 && found.diagnostics.clamped],
  [{ scale: "free" }, (found) => found.scale === plain.scale],
  [
    { scale: "free", knownExtentM: null, cameraUp: null, meshUp: null, initial: null, workBudget: null },
    (found) => found.scale === plain.scale,
  ],
  [{ knownExtentM: 0.2 }, (found) => near(found.scale * Math.max(...extent), 0.2)],
  [{ knownExtentM: 0.2, knownExtentAxis: "y" }, (found) => near(found.scale * (extent[1] ?? 0), 0.2)],
  [{ knownExtentM: 0.2, initial: truth }, (found) => near(found.scale * Math.max(...extent), 0.2)],
  [
    { initial: truth, scale: [0.05, 0.2] },
    (found) => found.diagnostics.counts.renders > plain.diagnostics.counts.renders,
  ],
  [
    { initial: truth, search: "local" },
    (found) => found.diagnostics.counts.renders < 0.5 * plain.diagnostics.counts.renders,
  ],
  [{ initial: worse, search: "local", scale: worse.scale }, (found) => near(found.scale, worse.scale)],
  [{ workBudget: 20 }, (found) => found.diagnostics.counts.renders < plain.diagnostics.counts.renders],
  [{ metrics: true, surfaceSamples: 300 }, (found) => found.diagnostics.counts.sourcePoints === 300],
  [{ maxObservedPoints: 400 }, (found) => found.diagnostics.counts.targetPoints === 400],
];

for (const [options, check] of effects) {
  test(`has its effect: ${JSON.stringify(options)}`, async () => {
    const found = await aligner.align(input, { ...quick, ...options });
    assertForms(found);
    assert.ok(check(found), JSON.stringify(found));
  });
}

test("an up direction chooses among poses that look alike", async () => {
  const { rotationMatrix } = await aligner.align(brick, { ...quick, symmetry: "none" });
  const up = rotationMatrix.map((row) => row[2]) as [number, number, number];
  for (const sign of [1, -1]) {
    const cameraUp = up.map((x) => 5 * sign * x) as [number, number, number];
    const found = await aligner.align(brick, { ...quick, cameraUp, meshUp: [0, 0, 0.1] });
    const turned = found.rotationMatrix.reduce((sum, row, i) => sum + row[2] * sign * (up[i] ?? 0), 0);
    assert.ok(turned > 0.9, `${turned}`);
  }
});

test("alternatives that a symmetry explains are left out", async () => {
  const listed = async (symmetry: AlignOptions["symmetry"]) =>
    (await aligner.align(brick, { ...quick, symmetry })).alternatives.filter(({ turnDeg }) => turnDeg > 170).length;
  assert.ok((await listed("none")) > 0);
  assert.ok((await listed([])) > 0);
  assert.equal(await listed("auto"), 0);
  const half = (axis: readonly [number, number, number]) => ({ axis, fold: 2 });
  assert.equal(await listed([half([2, 0, 0]), half([0, 1, 0]), half([0, 0, 1])]), 0);
});

test("an initial pose is taken in every form of a transform", async () => {
  const matrix = columnMajor(truth);
  const pose = await aligner.align(input, quick);
  const forms: Sim3Like[] = [
    matrix,
    Float32Array.from(matrix),
    { matrix: Float64Array.from(matrix) },
    { ...truth, rotation: rotationRows(truth.rotation) },
    { ...truth, rotation: Float64Array.from(truth.rotation) },
    pose,
    ...pose.alternatives.slice(0, 1),
  ];
  for (const initial of forms) assertForms(await aligner.align(input, { ...quick, initial, search: "local" }));
});

test("the same options give the same bits, also after other calls and errors", async () => {
  const options: AlignOptions = { ...quick, seed: 11, symmetry: "none", initial: truth };
  const first = withoutTimes(await aligner.align(input, options));
  await assert.rejects(aligner.align(input, { search: "local" }), { code: "INVALID_OPTION" });
  await aligner.align(input, { preset: "paper" });
  assert.deepEqual(withoutTimes(await aligner.align(input, options)), first);
  assert.deepEqual(withoutTimes(await (await createAligner()).align(input, options)), first);
});

test("an initial pose that is no option's business is left alone", async () => {
  const initial = Object.freeze({ ...truth, rotation: Object.freeze([...truth.rotation]), label: "annotated" });
  assertForms(await aligner.align(input, { ...quick, initial }));
});
