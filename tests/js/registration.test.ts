/** `register` and `estimateSim3` find similarities that are known. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner, ESTIMATE_SIM3_DEFAULTS, REGISTER_DEFAULTS, type Registration } from "sim3align";
import { type Refusals, refuses } from "../support/errors.js";
import { Random } from "../support/random.js";
import { mesh, type Pose, transformed } from "../support/scene.js";

const aligner = await createAligner();
const source = Float64Array.from(mesh.positions);
const pose: Pose = { scale: 2.5, rotation: [0.5, -0.5, 0.1, 0.7], translation: [30, -20, 10] };
pose.rotation = pose.rotation.map((x) => x / Math.hypot(...pose.rotation)) as Pose["rotation"];
const target = transformed(source, pose);

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
  const random = new Random(7);
  const pick = () => random.whole(0, source.length / 3 - 1);
  const correspondences = new Uint32Array(2 * count);
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

const bad: Refusals<() => Promise<unknown>> = {
  "a plain array: INVALID_ARGUMENT source": [
    () => aligner.register([1, 2, 3] as unknown as Float64Array, target),
    /a plain array of 3, expected a Float32Array or a Float64Array.*Float64Array\.from/,
  ],
  "no array: INVALID_ARGUMENT target": [() => aligner.register(source, "x" as unknown as Float64Array), /string/],
  "a broken triple: WRONG_LENGTH source": [() => aligner.register(source.slice(1), target), /multiple of 3/],
  "a NaN: NON_FINITE source": [() => aligner.estimateSim3(withNaN, target, pairs), /NaN in point 1/],
  "too few points: TOO_FEW_POINTS source": [() => aligner.register(source.slice(0, 30), target), /10 points/],
  "one point only: DEGENERATE_POINTS target": [
    () => aligner.register(source, new Float64Array(300)),
    /identical points/,
  ],
  "a bad scale: INVALID_OPTION options.scale": [() => aligner.register(source, target, { scale: -1 }), /"free"/],
  "a bad scale word: INVALID_OPTION options.scale": [
    () => aligner.register(source, target, { scale: "loose" as "free" }),
    /"free"/,
  ],
  "the scale word of earlier versions: INVALID_OPTION options.scale": [
    () => aligner.register(source, target, { scale: "fixed" as "free" }),
    /"fixed".*"free", a number above 0/,
  ],
  "a voxel grid that is too coarse: INVALID_OPTION options.voxelDivisions": [
    () => aligner.register(source, target, { voxelDivisions: 2 }),
    /from 5 to 200, or null/,
  ],
  "a bad option: INVALID_OPTION options.voxelSize": [
    () => aligner.register(source, target, { voxelSize: 0 }),
    /above 0/,
  ],
  "an option of align: UNKNOWN_OPTION options.guard": [
    () => aligner.register(source, target, { guard: null } as object),
  ],
  "plain correspondences: INVALID_ARGUMENT correspondences": [
    () => aligner.estimateSim3(source, target, [0, 0] as unknown as Uint32Array),
    /Uint32Array\.from/,
  ],
  "half a pair: WRONG_LENGTH correspondences": [() => aligner.estimateSim3(source, target, pairs.slice(1)), /even/],
  "an index too far: INDEX_OUT_OF_RANGE correspondences": [
    () => aligner.estimateSim3(source, target, Uint32Array.of(0, 0, 1, 1, 2, 1e6)),
    /pair 2/,
  ],
  "two pairs: TOO_FEW_POINTS correspondences": [
    () => aligner.estimateSim3(source, target, Uint32Array.of(0, 0, 50, 50)),
    /at least 3/,
  ],
};

refuses(bad, (call) => call());

test("after all that, the aligner works on", async () => {
  assertPose(await aligner.estimateSim3(source, target, pairs), 1e-6);
});

test("points on one line leave a turn free, which is no answer", async () => {
  const call = () =>
    aligner.estimateSim3(
      line,
      line,
      Uint32Array.from({ length: 60 }, (_, i) => i >> 1),
    );
  await assert.rejects(call, (error: { code: string }) => ["DEGENERATE_POINTS", "NO_CONSENSUS"].includes(error.code));
});
