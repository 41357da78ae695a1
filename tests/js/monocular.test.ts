/** Depth as models guess it, and cameras that nobody wrote down: what is unknown is estimated with the pose. */
import assert from "node:assert/strict";
import { after, test } from "node:test";
import { type AlignInput, createAligner, type DepthKind, type FrameInput, type Sim3 } from "sim3align";
import { correctDepth } from "sim3align/conventions";
import { refusesInputs } from "../support/bad-input.js";
import { codesOf, rejectsWith } from "../support/errors.js";
import { png } from "../support/files.js";
import { withoutTimes } from "../support/results.js";
import { frameAt, turnBetween } from "../support/rig.js";
import { input, mesh, truth, view } from "../support/scene.js";
import { poses, tableScene } from "../support/table.js";

const here = await createAligner();
const pool = await createAligner({ workers: 2 });
after(() => pool.dispose());

const quick = { quality: "fast" } as const;

/** What a model of each kind returns for a depth map. */
const predicted: Record<DepthKind, (depth: Float32Array) => Float32Array> = {
  metric: (depth) => depth.slice(),
  "scale-invariant": (depth) => depth.map((z) => 3.7 * z),
  "affine-invariant": (depth) => depth.map((z) => 2.1 * z - 1.1),
  "affine-invariant-disparity": (depth) => depth.map((z) => (z > 0 ? 5 / z - 1.5 : Number.NaN)),
};

const relative = (depthKind: DepthKind): AlignInput => ({
  ...input,
  depth: predicted[depthKind](view.depth),
  depthKind,
});

const disparity = relative("affine-invariant-disparity");
const disparityMap = { data: disparity.depth as Float32Array, width: view.width, height: view.height };
const expected = await here.align(disparity, quick);

/** Whether a pose looks as the true one: its direction, its apparent size, its rotation. */
function assertLooksLike(pose: Sim3, true_: Sim3 | typeof truth, [percent, degrees]: [number, number] = [4, 5]): void {
  const [x, y, z] = pose.translation;
  const [a, b, c] = true_.translation;
  assert.ok(Math.hypot(x / z - a / c, y / z - b / c) < percent / 100, `direction ${pose.translation}`);
  assert.ok(Math.abs(pose.scale / z / (true_.scale / c) - 1) < percent / 100, `apparent size ${pose.scale / z}`);
  assert.ok(turnBetween(pose.rotation, true_.rotation) < degrees, `rotation ${pose.rotation}`);
}

test("relative depth: the pose, and the shift that makes the depth map true to scale", () => {
  assertLooksLike(expected, truth);
  const { depthCalibration } = expected;
  assert.ok(depthCalibration !== undefined);
  const { depthKind, isMetric, isFocalEstimated, uncertainty } = depthCalibration;
  assert.deepEqual([depthKind, isMetric, isFocalEstimated], ["affine-invariant-disparity", false, false]);
  assert.equal(uncertainty.focal, 0);
  assert.ok(uncertainty.shift > 0 && uncertainty.shift < 0.2, `${uncertainty.shift}`);
  const { data: corrected } = correctDepth(disparityMap, depthCalibration);
  // The object and the wall behind it: their ratio is that of the true depths.
  const at = (i: number) => (corrected[i] ?? 0) / (view.depth[i] ?? 0);
  const ratio = at(0) / at(view.mask.indexOf(1));
  assert.ok(Math.abs(Math.log(ratio)) < 3 * uncertainty.shift + 0.05, `${ratio}`);
  assert.equal(expected.depthUnit, "none (affine-invariant-disparity)");
});

test("the confidence counts how well the shift is known", async () => {
  const { depthCalibration: calibration, matrix, confidence } = expected;
  assert.ok(calibration !== undefined);
  const depth = correctDepth(disparityMap, calibration);
  const measured = await here.align({ ...input, depth, camera: calibration.camera }, quick);
  assert.deepEqual(measured.matrix, matrix);
  const certainty = 1 - (calibration.uncertainty.shift / 0.43) ** 2;
  assert.ok(Math.abs(confidence - certainty * measured.confidence) < 1e-9, `${confidence}`);
});

test("affine-invariant depth has the same pose", async () => {
  const found = await here.align(relative("affine-invariant"), quick);
  assertLooksLike(found, truth);
  assert.equal(found.depthCalibration?.depthKind, "affine-invariant");
});

test("depth of unknown scale keeps its unit, and the bits of a metric map", async () => {
  const scaled = relative("scale-invariant");
  const { depthCalibration, depthUnit, ...found } = await here.align(scaled, quick);
  const { depthUnit: _, ...metric } = await here.align({ ...scaled, depthKind: "metric" } as AlignInput, quick);
  assert.deepEqual(withoutTimes(found), withoutTimes(metric));
  assert.equal(depthUnit, "unknown (scale-invariant)");
  const { isMetric, scale, shift } = depthCalibration ?? {};
  assert.deepEqual({ isMetric, scale, shift }, { isMetric: false, scale: 1, shift: 0 });
});

test("a known length makes relative depth metric", async () => {
  for (const depthKind of ["scale-invariant", "affine-invariant-disparity"] as const) {
    const found = await here.align(relative(depthKind), { ...quick, scale: truth.scale });
    assert.equal(found.depthCalibration?.isMetric, true);
    assert.ok(Math.abs(found.scale / truth.scale - 1) < 1e-6, `${found.scale}`);
    assert.ok(Math.abs(found.translation[2] / truth.translation[2] - 1) < 0.05, `${found.translation}`);
  }
});

test("metric depth with a known camera says its unit, and nothing was estimated", async () => {
  const found = await here.align(input, quick);
  assert.equal(found.depthCalibration, undefined);
  assert.equal(found.cameraSource, undefined);
  assert.equal(found.depthUnit, "metres (float values, assumed)");
  const millimetres = Uint16Array.from(view.depth, (z) => Math.round(1000 * z));
  assert.equal(
    (await here.align({ ...input, depth: millimetres }, quick)).depthUnit,
    "0.001 m (16-bit integers, assumed)",
  );
  const told = { ...input, depthKind: "metric", camera: { ...view.camera, focalUncertainty: 0 } } as AlignInput;
  assert.deepEqual(withoutTimes(await here.align(told, quick)), withoutTimes(found));
});

test("without a camera, the focal length is estimated from the object", async () => {
  const { depth, width, height, mask } = view;
  for (const camera of [undefined, { width, height }]) {
    const found = await here.align({ depth, width, height, mask, mesh, camera }, quick);
    const { depthCalibration, warnings } = found;
    assert.ok(depthCalibration?.isFocalEstimated && depthCalibration.isMetric);
    const error = Math.log(depthCalibration.camera.fx / view.camera.fx);
    assert.ok(Math.abs(error) < 3 * depthCalibration.uncertainty.focal, `${error}`);
    assert.ok(turnBetween(found.rotation, truth.rotation) < 6);
    assert.equal(found.cameraSource, "estimate");
    assert.deepEqual(codesOf(warnings), ["FOCAL_LENGTH_UNKNOWN"]);
  }
});

test("a focal length that is a guess is corrected", async () => {
  const { fx, fy, cx, cy } = view.camera;
  const camera = { fx: 1.2 * fx, fy: 1.2 * fy, cx, cy, focalUncertainty: 0.2 };
  const { depthCalibration, warnings } = await here.align({ ...input, camera }, quick);
  const found = Math.abs(Math.log((depthCalibration?.camera.fx ?? 0) / fx));
  assert.ok(found < 0.5 * Math.log(1.2), `${depthCalibration?.camera.fx}`);
  assert.deepEqual(warnings, []);
});

test("8 bits hold a disparity, in an array and in a PNG", async () => {
  const { width, height, camera, mask } = view;
  const bytes = Uint8Array.from(view.depth, (z) => Math.round(130 / z));
  const depthKind = "affine-invariant-disparity";
  const array = await here.align(
    { depth: bytes, width, height, mask, mesh, camera, depthKind } as unknown as AlignInput,
    quick,
  );
  assertLooksLike(array, truth, [5, 10]);
  const file = await here.align({ depth: png(bytes, width, height), mask, mesh, camera, depthKind }, quick);
  assert.deepEqual(withoutTimes(file), withoutTimes(array));
});

test("workers, a prepared mesh and moved arrays give the same bits", async () => {
  assert.deepEqual(withoutTimes(await pool.align(disparity, quick)), withoutTimes(expected));
  using prepared = await pool.prepareMesh(mesh);
  // Twice: by the second one, the worker knows the mesh.
  await pool.align({ ...input, mesh: prepared }, quick);
  for (const aligner of [pool, here]) {
    const found = await aligner.align({ ...disparity, mesh: prepared }, quick);
    assert.deepEqual(withoutTimes(found), withoutTimes(expected));
  }
  const { input: returned, ...moved } = await pool.align(structuredClone(disparity), { ...quick, transfer: true });
  assert.deepEqual(withoutTimes(moved), withoutTimes(expected));
  assert.equal((returned?.depth as Float32Array | undefined)?.length, view.depth.length);
});

test("progress never goes back, and a signal ends a calibration", async () => {
  const fractions: number[] = [];
  await here.align(disparity, { ...quick, onProgress: ({ fraction }) => fractions.push(fraction) });
  assert.ok(fractions.length > 3);
  assert.deepEqual(
    fractions,
    fractions.slice().sort((a, b) => a - b),
  );
  for (const aligner of [here, pool]) {
    const stop = new AbortController();
    const onProgress = () => stop.abort(new Error("enough"));
    await assert.rejects(() => aligner.align(disparity, { ...quick, signal: stop.signal, onProgress }), /enough/);
    const scene = { ...tableScene, depthKind: "affine-invariant" as const };
    await assert.rejects(
      () => aligner.alignScene(scene, { ...quick, signal: AbortSignal.timeout(50) }),
      /timeout|aborted/i,
    );
  }
});

test("the method of the paper works in the calibrated depth", async () => {
  const found = await here.align(disparity, { preset: "paper" });
  assert.equal(found.depthCalibration?.shift, expected.depthCalibration?.shift);
  assertLooksLike(found, truth, [15, 30]);
});

test("a point map may be of unknown scale, and nothing else", async () => {
  const { width, height, mask, camera } = view;
  const pointMap = new Float32Array(3 * view.depth.length);
  for (const [i, z] of view.depth.entries()) {
    const [u, v] = [i % width, Math.floor(i / width)];
    pointMap.set([(2 * z * (u - camera.cx)) / camera.fx, (2 * z * (v - camera.cy)) / camera.fy, 2 * z], 3 * i);
  }
  const points = { pointMap, width, height, mask, mesh };
  const found = await here.align({ ...points, depthKind: "scale-invariant" }, { ...quick, scale: truth.scale });
  assert.equal(found.depthCalibration?.isMetric, true);
  assertLooksLike(found, truth);
  assert.ok(Math.abs((found.depthCalibration?.scale ?? 0) - 0.5) < 0.02);
  const affine = { ...points, depthKind: "affine-invariant" } as unknown as AlignInput;
  await rejectsWith(() => here.align(affine), "INVALID_ARGUMENT depthKind", /"metric" or "scale-invariant"/);
});

test("a scene is calibrated once, by all its objects; one length makes it metric", async () => {
  const depth = predicted["affine-invariant-disparity"](tableScene.depth as Float32Array);
  const scene = { ...tableScene, depth, depthKind: "affine-invariant-disparity" as const };
  const [first, ...others] = scene.objects;
  assert.ok(first !== undefined);
  const objects = [{ ...first, scale: poses[0]?.scale as number }, ...others];
  const found = await here.alignScene({ ...scene, objects }, quick);
  assert.equal(found.depthCalibration?.isMetric, true);
  for (const [i, object] of found.objects.entries()) {
    assert.ok(object.error === undefined);
    const scale = poses[i]?.scale ?? 0;
    assert.ok(Math.abs(object.scale / scale - 1) < 0.06, `${i}: ${object.scale} for ${scale}`);
    assert.equal("depthCalibration" in object, false);
  }
  const timeless = ({ objects, ...more }: typeof found) => ({
    ...more,
    objects: objects.map((object) => (object.error === undefined ? withoutTimes(object) : object)),
  });
  assert.deepEqual(timeless(await pool.alignScene({ ...scene, objects }, quick)), timeless(found));
});

test("an object that cannot be read does not end a scene of relative depth", async () => {
  const depth = predicted["affine-invariant"](tableScene.depth as Float32Array);
  const [first, second] = tableScene.objects;
  const broken = { ...second, mesh: new Uint8Array([1, 2, 3]) };
  const scene = { ...tableScene, depth, depthKind: "affine-invariant", objects: [first, broken] } as typeof tableScene;
  const { objects } = await here.alignScene(scene, quick);
  assert.equal(objects[0]?.error, undefined);
  assert.equal(objects[1]?.error?.argument, "mesh");
});

test("views of relative depth have one size, and the cameras' distance makes it metric", async () => {
  const rig = [0, 60, 120].map((angle) => frameAt(angle));
  const views = rig.map(({ frame, cameraToWorld }, k) => ({
    ...frame,
    depth: frame.depth.map((z) => (4 + k) / z - 1),
    depthKind: "affine-invariant-disparity" as const,
    cameraToWorld,
  }));
  const found = await here.alignViews({ mesh, views }, quick);
  assert.ok(Math.abs(found.scale / truth.scale - 1) < 0.06, `${found.scale}`);
  assert.ok(turnBetween(found.rotation, truth.rotation) < 5);
  assert.ok(found.views.every((each) => each.depthCalibration?.isMetric));
  assert.deepEqual(withoutTimes(await pool.alignViews({ mesh, views }, quick)), withoutTimes(found));
});

test("a video of relative depth has one size, in a unit of its own", async () => {
  const video = [0, 3, 6].map((angle) => frameAt(angle));
  const frames = video.map(
    ({ frame }, k): FrameInput => ({
      ...frame,
      depth: frame.depth.map((z) => (4 + 0.2 * k) / z - 1 - 0.1 * k),
      depthKind: "affine-invariant-disparity",
    }),
  );
  const tracked = async (aligner: typeof here) => {
    using tracker = await aligner.track(mesh);
    return await Promise.all(frames.map((frame) => tracker.next(frame)));
  };
  const found = await tracked(here);
  for (const [k, frame] of found.entries()) {
    assert.equal(frame.state, "tracking");
    assert.ok(turnBetween(frame.rotation, video[k]?.pose.rotation ?? []) < 6, `frame ${k}`);
    assert.ok(Math.abs(frame.scale / (found[0]?.scale ?? 0) - 1) < 0.03, `frame ${k}: ${frame.scale}`);
    assert.equal(frame.depthCalibration?.isMetric, false);
  }
  assert.deepEqual(await tracked(pool), found);
});

test("lengths are not measured in what is not known", async () => {
  await rejectsWith(() => here.evaluate(disparity, expected), "INVALID_ARGUMENT depthKind", /correctDepth/);
  await rejectsWith(
    () => here.evaluate({ ...input, camera: undefined } as AlignInput, truth),
    "INVALID_ARGUMENT camera",
    /focal/,
  );
  const { depthCalibration } = expected;
  assert.ok(depthCalibration !== undefined);
  const depth = correctDepth(disparityMap, depthCalibration);
  const { metrics } = await here.evaluate({ ...input, depth, camera: depthCalibration.camera }, expected);
  assert.deepEqual(metrics, expected.metrics);
});

refusesInputs({
  "an unknown kind of depth: INVALID_ARGUMENT depthKind": [{ depthKind: "relative" }, /"affine-invariant-disparity"/],
  "an uncertainty of 100 %: INVALID_ARGUMENT camera.focalUncertainty": [
    { camera: { ...view.camera, focalUncertainty: 100 } },
    /0\.1 for 10 %/,
  ],
  "the size of another image: SIZE_MISMATCH camera": [{ camera: { width: 640, height: 480 } }, /640 × 480/],
  "disparity that is nothing: NO_DEPTH_IN_MASK depth": [
    { depthKind: "affine-invariant-disparity", depth: view.depth.map(() => Number.NaN) },
    /no reading/,
  ],
});
