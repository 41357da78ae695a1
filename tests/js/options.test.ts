/** Every option of every call reaches the core: each changes the outcome. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner, OPTIONS } from "sim3align";
import { bits } from "../support/results.js";
import { frameAt } from "../support/rig.js";
import { brick, input, mesh, product, transformed, truth } from "../support/scene.js";

const aligner = await createAligner();
const quick = { quality: "fast" } as const;

/** The brick narrowed along x, whose half turns look alike. */
const narrow = { ...brick.mesh, positions: brick.mesh.positions.map((x, i) => (i % 3 === 0 ? 0.9 * x : x)) };
const views = [0, 120]
  .map((angle) => frameAt(angle, brick.mesh))
  .map(({ frame, cameraToWorld }) => ({ ...frame, cameraToWorld }));
const halfTurned = { ...truth, scale: 1.02 * truth.scale, rotation: product(truth.rotation, [0, 0, 1, 0]) };
const cloud = Float64Array.from(mesh.positions.subarray(0, 1500));
// A third of the correspondences is wrong.
const pairs = Uint32Array.from({ length: 900 }, (_, i) => (i % 6 === 1 ? (7 * i) % 500 : i >> 1));
const target = transformed(cloud, { ...truth, scale: 2 }).map((x, i) => x + 0.01 * Math.sin(7 * i));

async function tracked({ mask, mesh, ...frame }: typeof input | typeof brick, options: object): Promise<unknown> {
  using tracker = await aligner.track(mesh, options);
  return await tracker.next((options as { initial?: object | null }).initial ? frame : { ...frame, mask });
}

type Method = Exclude<keyof typeof OPTIONS, "alignScene">;
const calls: Record<Method, (options: object) => Promise<unknown>> = {
  align: (options) => aligner.align({ ...brick, mesh: narrow }, { ...quick, ...options }),
  paper: (options) =>
    aligner.align(input, { preset: "paper", surfaceSamples: 3000, ransacIterations: 2000, ...options }),
  alignViews: (options) => aligner.alignViews({ mesh: narrow, views }, { ...quick, ...options }),
  track: (options) => tracked(input, options),
  evaluate: (options) => aligner.evaluate(brick, halfTurned, { truth, ...options }),
  register: (options) => aligner.register(cloud, target, { ransacIterations: 2000, ...options }),
  estimateSim3: (options) => aligner.estimateSim3(cloud, target, pairs, options),
};

const { mask, mesh: _, ...seen } = brick;
const scene = { ...seen, objects: [{ mask, mesh: narrow }] };
const allCalls: Record<keyof typeof OPTIONS, (options: object) => Promise<unknown>> = {
  ...calls,
  alignScene: (options) => aligner.alignScene(scene, { ...quick, ...options }),
};

test("the table has the default of every option: passing it changes nothing", async () => {
  // Options that the calls of this test set themselves.
  const set = ["quality", "surfaceSamples", "ransacIterations", "truth"];
  for (const [method, call] of Object.entries(allCalls) as [keyof typeof OPTIONS, (typeof allCalls)["align"]][]) {
    const rows = OPTIONS[method].filter(({ name }) => !set.includes(name));
    const defaults = Object.fromEntries(rows.map(({ name, default: value }) => [name, value]));
    assert.ok(rows.length > 3 && bits(await call(defaults)) === bits(await call({})), method);
  }
});

/** Values other than the defaults; an object has further options that go with the one of its name. */
const shared = { seed: 5, maxObservedPoints: 300, surfaceSamples: 200 };
const sizes = { scale: 0.08, knownExtentM: 0.2, knownExtentAxis: { knownExtentM: 0.2, knownExtentAxis: "x" } };
const ups = { cameraUp: [0, -1, 0.2], meshUp: [1, 0, 0] };
const clouds = { scale: 2, seed: 5, ransacConfidence: 0.5, ransacIterations: 3, edgeSimilarity: 0.99999 };
const values: Record<Method, Record<string, unknown>> = {
  align: {
    ...{
      ...shared,
      ...sizes,
      quality: "best",
      cameraUp: ups,
      meshUp: ups,
      symmetry: "none",
      initial: truth,
      workBudget: 20,
    },
    ...{ search: { initial: truth, search: "local" }, proportions: "full", metrics: false },
  },
  paper: {
    ...{ ...shared, metrics: false, voxelDivisions: 20, fpfhRadiusVoxels: 4, guard: [0.99, 1.01] },
    ...{ guardMode: { guard: [0.999, 1.001], guardMode: "clamp" }, ransacIterations: 500, ransacConfidence: 0.5 },
    ...{ inlierDistanceVoxels: 1, edgeSimilarity: 0.95, hallucinationFilter: false, supportDistanceVoxels: 1 },
    ...{ supportAngleDeg: 20, icp: "none", lockScale: false, icpIterations: 1 },
  },
  alignViews: { ...shared, ...sizes, quality: "balanced", symmetry: "none", proportions: "axes", metrics: false },
  track: { ...sizes, quality: "best", initial: truth, metrics: true },
  evaluate: { ...shared, measuredPoints: 64, truth: halfTurned, symmetry: "none" },
  register: {
    ...{ ...clouds, maxPoints: 200, voxelSize: 0.3, voxelDivisions: 10, fpfhRadiusVoxels: 3 },
    ...{ inlierDistanceVoxels: 0.5, icp: "none", icpIterations: 1, workBudget: 1 },
  },
  estimateSim3: { ...clouds, edgeSimilarity: 0.999, inlierDistance: 0.005 },
};

/**
 * A budget that only a call without end shows (cancel.test.ts), a seed that no frame of this video depends on, and what
 * matters for a symmetric object alone.
 */
const others = ["estimateSim3 workBudget", "track seed", "track symmetry"];

test("symmetry changes the confidence in a tracked object whose half turns look alike", async () => {
  const seen = { ...brick, mesh: narrow };
  assert.notEqual(bits(await tracked(seen, { symmetry: "none" })), bits(await tracked(seen, {})));
});

for (const [method, call] of Object.entries(calls) as [Method, (typeof calls)[Method]][]) {
  test(`every option of ${method} changes the outcome`, async () => {
    const names = OPTIONS[method].map(({ name }) => name).filter((name) => !others.includes(`${method} ${name}`));
    assert.deepEqual(Object.keys(values[method]).sort(), names.sort());
    const plain = bits(await call({}));
    for (const [name, value] of Object.entries(values[method])) {
      const isSet = typeof value === "object" && value !== null && name in value;
      assert.ok(bits(await call(isSet ? value : { [name]: value })) !== plain, name);
    }
  });
}
