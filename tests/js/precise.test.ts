/** The options of `precise`: what is accepted, and that every answer is a similarity. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { type Alignment, type AlignOptions, createAligner, type Sim3Like } from "sim3align";
import { columnMajor, input, rotationRows, truth } from "../support/scene.js";

const aligner = await createAligner();
const quick = { quality: "fast" } as const;
const withoutTimes = ({ timingsMs: _, ...result }: Alignment) => result;

function assertSimilarity({ scale, rotationMatrix, translation, matrix }: Alignment): void {
  assert.ok(scale > 0 && Number.isFinite(scale));
  for (const [i, row] of rotationMatrix.entries()) {
    for (const [j, other] of rotationMatrix.entries()) {
      const product = row.reduce((sum, x, k) => sum + x * (other[k] ?? 0), 0);
      assert.ok(Math.abs(product - (i === j ? 1 : 0)) < 1e-9, "rows of length 1 at right angles");
      assert.ok(Math.abs((matrix[4 * j + i] ?? 0) - scale * (row[j] ?? 0)) < 1e-9);
    }
    assert.equal(matrix[12 + i], translation[i]);
  }
}

const accepted: readonly AlignOptions[] = [
  { quality: "balanced" },
  { quality: "best", budgetMs: 100 },
  { scale: truth.scale },
  { scale: [0.05, 0.2] },
  { scale: { min: 0.05, max: 0.2 } },
  { scale: null, knownExtentM: null, cameraUp: null, meshUp: null, initial: null, budgetMs: null, lockScale: null },
  { scale: truth.scale, lockScale: true },
  { knownExtentM: 0.2 },
  { knownExtentM: 0.2, knownExtentAxis: "z" },
  { knownExtentM: 0.2, initial: truth },
  { cameraUp: [0, -1, 0], meshUp: [0, 1, 0] },
  { cameraUp: [0, -10, 0.5], meshUp: [0, 0, 0.1] },
  { symmetry: "none" },
  { symmetry: "auto-revolution" },
  { symmetry: [{ axis: [0, 0, 2], fold: 2 }, { axis: [1, 0, 0] }] },
  { symmetry: [] },
  { initial: truth, scale: [0.05, 0.2] },
  { initial: truth, search: "local" },
  { initial: truth, search: "local", lockScale: true },
  { lockScale: true },
  { lockScale: false },
  { budgetMs: 50 },
];

for (const options of accepted) {
  test(`accepted: ${JSON.stringify(options)}`, async () => {
    assertSimilarity(await aligner.align(input, { ...quick, ...options }));
  });
}

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
  for (const initial of forms) assertSimilarity(await aligner.align(input, { ...quick, initial, search: "local" }));
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
  assertSimilarity(await aligner.align(input, { ...quick, initial }));
});
