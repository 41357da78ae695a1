/** Options of the calls: their defaults, and the effects of those that no test of the core has. */
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

const { mask, mesh: _, ...seen } = brick;
const scene = { ...seen, objects: [{ mask, mesh: narrow }] };
type Method = keyof typeof OPTIONS;
const calls: Record<Method, (options: object) => Promise<unknown>> = {
  align: (options) => aligner.align({ ...brick, mesh: narrow }, { ...quick, ...options }),
  paper: (options) =>
    aligner.align(input, { preset: "paper", surfaceSamples: 3000, ransacIterations: 2000, ...options }),
  alignViews: (options) => aligner.alignViews({ mesh: narrow, views }, { ...quick, ...options }),
  track: (options) => tracked(input, options),
  evaluate: (options) => aligner.evaluate(brick, halfTurned, { truth, ...options }),
  register: (options) => aligner.register(cloud, target, { ransacIterations: 2000, ...options }),
  estimateSim3: (options) => aligner.estimateSim3(cloud, target, pairs, options),
  alignScene: (options) => aligner.alignScene(scene, { ...quick, ...options }),
};

test("the table has the default of every option: passing it changes nothing", async () => {
  // Options that the calls of this test set themselves.
  const set = ["quality", "surfaceSamples", "ransacIterations", "truth"];
  for (const [method, call] of Object.entries(calls) as [Method, (typeof calls)[Method]][]) {
    const rows = OPTIONS[method].filter(({ name }) => !set.includes(name));
    const defaults = Object.fromEntries(rows.map(({ name, default: value }) => [name, value]));
    assert.ok(rows.length > 3 && bits(await call(defaults)) === bits(await call({})), method);
  }
});

/** Values other than the defaults; an object has further options that go with the one of its name. */
const shared = { seed: 5, maxObservedPoints: 300, surfaceSamples: 200 };
const sizes = { scale: 0.08, knownExtentM: 0.2, knownExtentAxis: { knownExtentM: 0.2, knownExtentAxis: "x" } };
const values: Partial<Record<Method, Record<string, unknown>>> = {
  alignViews: { ...shared, ...sizes, quality: "balanced", symmetry: "none", proportions: "axes", metrics: false },
  track: { ...sizes, quality: "best", initial: truth, metrics: true },
  evaluate: { ...shared, measuredPoints: 64, truth: halfTurned, symmetry: "none" },
};

/** A seed that no frame of this video depends on, and what matters for a symmetric object alone. */
const others = ["track seed", "track symmetry"];

test("symmetry changes the confidence in a tracked object whose half turns look alike", async () => {
  const seen = { ...brick, mesh: narrow };
  assert.notEqual(bits(await tracked(seen, { symmetry: "none" })), bits(await tracked(seen, {})));
});

for (const [method, changes] of Object.entries(values) as [Method, Record<string, unknown>][]) {
  test(`every option of ${method} changes the outcome`, async () => {
    const names = OPTIONS[method].map(({ name }) => name).filter((name) => !others.includes(`${method} ${name}`));
    assert.deepEqual(Object.keys(changes).sort(), names.sort());
    const call = calls[method];
    const plain = bits(await call({}));
    for (const [name, value] of Object.entries(changes)) {
      const isSet = typeof value === "object" && value !== null && name in value;
      assert.ok(bits(await call(isSet ? value : { [name]: value })) !== plain, name);
    }
  });
}
