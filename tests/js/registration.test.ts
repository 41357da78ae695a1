/** `register` and `estimateSim3` find similarities that are known. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner, ESTIMATE_SIM3_DEFAULTS, REGISTER_DEFAULTS, type Registration } from "sim3align";
import { rejectsWith } from "../support/errors.js";
import { mesh, type Pose, transformed } from "../support/scene.js";

const aligner = await createAligner();
const source = Float64Array.from(mesh.positions);
const pose: Pose = { scale: 2.5, rotation: [0.5, -0.5, 0.1, 0.7], translation: [30, -20, 10] };
pose.rotation = pose.rotation.map((x) => x / Math.hypot(...pose.rotation)) as Pose["rotation"];
const target = transformed(source, pose);

/** The same random numbers each time, in [0, 1). */
function* random(seed: number): Generator<number, never> {
  let state = seed;
  for (;;) {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    yield state / 2 ** 32;
  }
}

function assertPose(
  { scale, rotation, translation }: Pick<Registration, "scale" | "rotation" | "translation">,
  tolerance: number,
  expected = pose,
): void {
  assert.ok(Math.abs(scale / expected.scale - 1) < tolerance, `scale ${scale}`);
  const cosine = Math.abs(rotation.reduce((sum, x, i) => sum + x * (expected.rotation[i] ?? 0), 0));
  assert.ok(2 * Math.acos(Math.min(1, cosine)) < Math.max(tolerance, 1e-6), `rotation ${rotation}`);
  const far = Math.hypot(...translation.map((x, i) => x - (expected.translation[i] ?? 0)));
  assert.ok(far < 10 * tolerance, `translation ${translation}`);
}

test("register finds scale, rotation and translation of a cloud", async () => {
  const result = await aligner.register(source, target);
  assertPose(result, 1e-4);
  assert.ok(Array.isArray(result.matrix) && result.matrix.length === 16);
  assert.ok(result.fitness > 0.99, `${result.fitness}`);
  const { scaleRatio, converged } = result.diagnostics;
  assert.ok(scaleRatio > 0.2 && scaleRatio < 5);
  assert.equal(converged, true);
});

test("register takes floats of both sizes, and gives the same bits twice", async () => {
  const run = async () => {
    const { diagnostics, ...result } = await aligner.register(mesh.positions, target, { seed: 9 });
    const { timingsMs: _, ...others } = diagnostics;
    return { ...result, ...others };
  };
  const first = await run();
  assertPose(first, 1e-4);
  assert.deepEqual(await run(), first);
});

test("register keeps to a scale that is known, fixed or bounded", async () => {
  assertPose(await aligner.register(source, target, { scale: 2.5 }), 1e-4);
  const bounded = await aligner.register(source, target, { scale: [2, 3] });
  assertPose(bounded, 1e-4);
  const rigid = transformed(source, { ...pose, scale: 1 });
  const fixed = await aligner.register(source, rigid, { scale: 1 });
  assert.equal(fixed.scale, 1);
  assertPose(fixed, 1e-4, { ...pose, scale: 1 });
});

test("estimateSim3 finds the transform that correct correspondences agree on, among wrong ones", async () => {
  const count = 300;
  const numbers = random(7);
  const pick = () => Math.floor(numbers.next().value * (source.length / 3));
  const correspondences = Uint32Array.from({ length: 2 * count }, () => 0);
  for (let i = 0; i < count; i++) {
    const index = pick();
    correspondences[2 * i] = index;
    correspondences[2 * i + 1] = i % 2 === 0 ? index : pick();
  }
  const result = await aligner.estimateSim3(source, target, correspondences, { inlierDistance: 0.01 });
  assertPose(result, 1e-5);
  const { counts } = result.diagnostics;
  assert.equal(counts.matches, count);
  assert.ok(counts.inliers >= count / 2, `${counts.inliers}`);
  assert.ok(Math.abs(result.fitness - counts.inliers / count) < 1e-9);
});

test("the defaults passed as options change nothing", async () => {
  const [plain, spelt] = [
    await aligner.register(source, target),
    await aligner.register(source, target, REGISTER_DEFAULTS),
  ];
  assert.deepEqual(spelt.matrix, plain.matrix);
  const estimated = await aligner.estimateSim3(source, target, pairs, ESTIMATE_SIM3_DEFAULTS);
  assert.deepEqual(estimated.matrix, (await aligner.estimateSim3(source, target, pairs)).matrix);
  const bounded = await aligner.estimateSim3(source, target, pairs, { scale: [2.4, 2.6] });
  assertPose(bounded, 1e-5);
  const outside = aligner.estimateSim3(source, target, pairs, { scale: [3, 4] });
  await assert.rejects(outside, { code: "NO_CONSENSUS" });
});

const line = Float64Array.from({ length: 300 }, (_, i) => (i % 3 === 0 ? i : 0));
const withNaN = source.slice();
withNaN[4] = Number.NaN;
const pairs = Uint32Array.from({ length: 20 }, (_, i) => 40 * Math.floor(i / 2));

type Call = () => Promise<unknown>;
const bad: [name: string, call: Call, code: string, argument: string, message: RegExp][] = [
  [
    "a plain array",
    () => aligner.register([1, 2, 3] as unknown as Float64Array, target),
    "INVALID_ARGUMENT",
    "source",
    /a plain array of 3, expected a Float32Array or a Float64Array.*Float64Array\.from/,
  ],
  ["no array", () => aligner.register(source, "x" as unknown as Float64Array), "INVALID_ARGUMENT", "target", /string/],
  ["a broken triple", () => aligner.register(source.slice(1), target), "WRONG_LENGTH", "source", /multiple of 3/],
  ["a NaN", () => aligner.estimateSim3(withNaN, target, pairs), "NON_FINITE", "source", /NaN in point 1/],
  ["too few points", () => aligner.register(source.slice(0, 30), target), "TOO_FEW_POINTS", "source", /10 points/],
  [
    "one point only",
    () => aligner.register(source, new Float64Array(300)),
    "DEGENERATE_POINTS",
    "target",
    /identical points/,
  ],
  ["a bad scale", () => aligner.register(source, target, { scale: -1 }), "INVALID_OPTION", "options.scale", /"free"/],
  [
    "a bad scale word",
    () => aligner.register(source, target, { scale: "loose" as "free" }),
    "INVALID_OPTION",
    "options.scale",
    /"free"/,
  ],
  [
    "the scale word of earlier versions",
    () => aligner.register(source, target, { scale: "fixed" as "free" }),
    "INVALID_OPTION",
    "options.scale",
    /"fixed".*"free", a number above 0/,
  ],
  [
    "a voxel grid that is too coarse",
    () => aligner.register(source, target, { voxelDivisions: 2 }),
    "INVALID_OPTION",
    "options.voxelDivisions",
    /from 5 to 200, or null/,
  ],
  [
    "a bad option",
    () => aligner.register(source, target, { voxelSize: 0 }),
    "INVALID_OPTION",
    "options.voxelSize",
    /above 0/,
  ],
  [
    "an option of align",
    () => aligner.register(source, target, { guard: null } as object),
    "UNKNOWN_OPTION",
    "options.guard",
    /./,
  ],
  [
    "plain correspondences",
    () => aligner.estimateSim3(source, target, [0, 0] as unknown as Uint32Array),
    "INVALID_ARGUMENT",
    "correspondences",
    /Uint32Array\.from/,
  ],
  [
    "half a pair",
    () => aligner.estimateSim3(source, target, pairs.slice(1)),
    "WRONG_LENGTH",
    "correspondences",
    /even/,
  ],
  [
    "an index too far",
    () => aligner.estimateSim3(source, target, Uint32Array.of(0, 0, 1, 1, 2, 1e6)),
    "INDEX_OUT_OF_RANGE",
    "correspondences",
    /pair 2/,
  ],
  [
    "two pairs",
    () => aligner.estimateSim3(source, target, Uint32Array.of(0, 0, 50, 50)),
    "TOO_FEW_POINTS",
    "correspondences",
    /at least 3/,
  ],
];

for (const [name, call, code, argument, message] of bad) {
  test(`${name}: ${code}`, async () => {
    await rejectsWith(call, { code: code as "INTERNAL", argument, message });
    assertPose(await aligner.estimateSim3(source, target, pairs), 1e-6);
  });
}

test("points on one line leave a turn free, which is no answer", async () => {
  const call = () =>
    aligner.estimateSim3(
      line,
      line,
      Uint32Array.from({ length: 60 }, (_, i) => i >> 1),
    );
  await assert.rejects(call, (error: { code: string }) => ["DEGENERATE_POINTS", "NO_CONSENSUS"].includes(error.code));
});
