/** Depth as models guess it, and cameras that nobody wrote down: what is unknown is estimated with the pose. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { type AlignInput, createAligner, type DepthKind, type FrameInput, type ViewInput } from "sim3align";
import { correctDepth } from "sim3align/conventions";
import { codesOf, rejectsWith } from "../support/errors.js";
import { frameAt, turnBetween } from "../support/rig.js";
import { input, mesh, truth, view } from "../support/scene.js";
import { poses, tableScene } from "../support/table.js";

const here = await createAligner();

const quick = { quality: "fast" } as const;
const { width, height, mask, camera } = view;

/** x/z and y/z of the ray of a pixel. */
const rayOf = (i: number) =>
  [((i % width) - camera.cx) / camera.fx, (Math.floor(i / width) - camera.cy) / camera.fy] as const;

/** The output of a model of each kind for a depth map. */
const predicted: Record<DepthKind, (depth: Float32Array) => Float32Array> = {
  metric: (depth) => depth.slice(),
  "ray-distance": (depth) => depth.map((z, i) => z * Math.hypot(1, ...rayOf(i))),
  "scale-invariant": (depth) => depth.map((z) => 3.7 * z),
  "affine-invariant": (depth) => depth.map((z) => 2.1 * z - 1.1),
  "affine-invariant-disparity": (depth) => depth.map((z) => (z > 0 ? 5 / z - 1.5 : Number.NaN)),
};
const relative = (depthKind: DepthKind): AlignInput => ({
  ...{ ...input, depth: predicted[depthKind](view.depth), depthKind },
});

test("distances along the rays are the depth that they belong to", async () => {
  const distances = relative("ray-distance");
  const { data } = correctDepth(
    { data: distances.depth as Float32Array, width, height },
    { depthKind: "ray-distance", camera },
  );
  for (const [i, z] of view.depth.entries())
    assert.ok(Math.abs((data[i] ?? 0) - z) <= 1e-6 * z, `${data[i]} is not ${z}`);
  const [rays, depth] = [await here.align(distances, quick), await here.align({ ...input, depth: data }, quick)];
  const unit = { metres: 1, source: "float values", isAssumed: true };
  assert.deepEqual([rays.matrix, rays.depthUnit], [depth.matrix, unit]);
  assert.equal(rays.depthCalibration, undefined);
});

const disparity = relative("affine-invariant-disparity");
const disparityMap = { data: disparity.depth as Float32Array, width, height };
const found = await here.align(disparity, quick);
const calibration = found.depthCalibration as NonNullable<typeof found.depthCalibration>;

test("the pose and the metrics are those in the corrected map", async () => {
  const depth = correctDepth(disparityMap, calibration);
  const measured = await here.align({ ...input, depth, camera: calibration.camera }, quick);
  assert.deepEqual(measured.matrix, found.matrix);
  assert.ok(found.confidence < measured.confidence, "the shift is in doubt");
  const { metrics } = await here.evaluate({ ...input, depth, camera: calibration.camera }, found);
  // The rotation, read from the result, is rounded once more.
  for (const [name, value] of Object.entries(found.metrics ?? {}))
    assert.ok(
      Math.abs(Number(metrics[name as keyof typeof metrics]) - Number(value)) <= 1e-12,
      `${name} is not ${value}`,
    );
  await rejectsWith(() => here.evaluate(disparity, found), "INVALID_ARGUMENT depthKind", /correctDepth/);
  const uncalibrated = { ...input, camera: undefined } as AlignInput;
  await rejectsWith(() => here.evaluate(uncalibrated, truth), "INVALID_ARGUMENT camera", /focal/);
});

test("a missing focal length is estimated from the object, with a warning, and a guess is corrected", async () => {
  const { depth } = view;
  for (const unknown of [undefined, { width, height }]) {
    const alone = await here.align({ depth, width, height, mask, mesh, camera: unknown }, quick);
    const { depthCalibration, warnings, cameraSource, rotation } = alone;
    assert.ok(depthCalibration?.isFocalEstimated && depthCalibration.isMetric);
    const error = Math.log(depthCalibration.camera.fx / camera.fx);
    assert.ok(Math.abs(error) < 3 * depthCalibration.uncertainty.focal, `${error}`);
    assert.ok(turnBetween(rotation, truth.rotation) < 6);
    assert.deepEqual([cameraSource, codesOf(warnings)], ["estimate", ["FOCAL_LENGTH_UNKNOWN"]]);
  }
  const guess = { ...camera, fx: 1.2 * camera.fx, fy: 1.2 * camera.fy, focalUncertainty: 0.2 };
  const { depthCalibration, warnings } = await here.align({ ...input, camera: guess }, quick);
  const left = Math.abs(Math.log((depthCalibration?.camera.fx ?? 0) / camera.fx));
  assert.ok(left < 0.5 * Math.log(1.2), `${depthCalibration?.camera.fx}`);
  assert.deepEqual(warnings, []);
});

test("a scene is calibrated once, by all its objects; one length makes it metric", async () => {
  const depthKind = "affine-invariant-disparity" as const;
  const depth = predicted[depthKind](tableScene.depth as Float32Array);
  const objects = tableScene.objects.map((object, i) => (i === 0 ? { ...object, scale: poses[0]?.scale } : object));
  const scene = { ...tableScene, depth, depthKind, objects } as typeof tableScene;
  const result = await here.alignScene(scene, quick);
  assert.equal(result.depthCalibration?.isMetric, true);
  for (const [i, object] of result.objects.entries()) {
    const scale = poses[i]?.scale ?? 0;
    assert.ok(object.error === undefined && Math.abs(object.scale / scale - 1) < 0.06, `${i}`);
  }
});

test("views of relative depth have one size, and the cameras' distance makes it metric", async () => {
  const views = [0, 60, 120].map((angle, k) => {
    const { frame, cameraToWorld } = frameAt(angle);
    const depth = frame.depth.map((z) => (4 + k) / z - 1);
    return { ...frame, depth, depthKind: "affine-invariant-disparity" as const, cameraToWorld };
  });
  const all = await here.alignViews({ mesh, views }, quick);
  assert.ok(all.views.every((each) => each.depthCalibration?.isMetric));
});

/** The factor that lowers a confidence, which follows from the uncertainty of the calibration. */
const certainty = ({ depthCalibration }: { depthCalibration?: { uncertainty: { shift: number; focal: number } } }) => {
  const { shift, focal } = depthCalibration?.uncertainty ?? assert.fail("no calibration");
  return 1 - (shift ** 2 - focal ** 2) / 0.43 ** 2;
};

test("in corrected depth, each call has the same pose, and is surer by what the calibration leaves open", async () => {
  const frame = { width, height, mask, camera: calibration.camera };
  const relativeDepth = { depth: disparityMap.data, depthKind: "affine-invariant-disparity" } as const;
  const { data: depth } = correctDepth(disparityMap, calibration);
  const tracked = async (frame: FrameInput) => {
    const tracker = await here.track(mesh);
    const pose = await tracker.next(frame);
    await tracker.dispose();
    return pose;
  };
  const inViews = async (view: ViewInput) => (await here.alignViews({ mesh, views: [view] }, quick)).views[0];
  for (const call of [tracked, inViews]) {
    const [estimated, known] = [await call({ ...frame, ...relativeDepth }), await call({ ...frame, depth })];
    assert.ok(estimated !== undefined && known !== undefined);
    assert.ok(Math.abs(estimated.scale / known.scale - 1) < 1e-3, `${estimated.scale} and ${known.scale}`);
    const share = estimated.confidence / known.confidence / certainty(estimated);
    assert.ok(certainty(estimated) < 0.999 && Math.abs(share - 1) < 1e-3, `${call.name}: ${share}`);
  }
});
