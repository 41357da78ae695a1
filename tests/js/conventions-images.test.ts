/** Tensors, depth, point maps, and images of another size, with the camera kept right. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner } from "sim3align";
import {
  cropInput,
  depthFromDisparity,
  depthFromTensor,
  maskBox,
  maskFromTensor,
  pointMapFromMoge,
  resizeCamera,
  resizeDepth,
  resizeMask,
} from "sim3align/conventions";
import { fixtures } from "../support/conventions.js";
import { type Refused, rejectsWith } from "../support/errors.js";
import { assertNear, forSeeds } from "../support/random.js";
import { mesh, truth, view } from "../support/scene.js";

const { width, height, camera } = view;
const depth = { data: view.depth, width, height };
const mask = { data: view.mask, width, height };

test("a mask is chosen from a tensor by its number or its score", () => {
  const data = Uint8Array.of(1, 0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1);
  const tensor = { data, dims: [1, 3, 2, 3] };
  const scores = { data: Float32Array.of(0.2, 0.9, 0.4), dims: [1, 1, 3] };
  assert.deepEqual([...maskFromTensor(tensor, { scores }).data], [1, 1, 0, 0, 0, 0]);
  assert.deepEqual([...maskFromTensor(tensor, { scores: [0.2, 0.1, 0.4] }).data], [0, 0, 0, 0, 1, 1]);
  assert.deepEqual(maskFromTensor(tensor, { index: 0 }), {
    data: Uint8Array.of(1, 0, 0, 0, 0, 0),
    width: 3,
    height: 2,
  });
  assert.deepEqual([...maskFromTensor({ data: [true, false], dims: [1, 2] }).data], [1, 0]);
  const logits = { data: Float32Array.of(-3, 0.1, Number.NaN, 7, 0, -0), dims: [1, 1, 2, 3] };
  assert.deepEqual([...maskFromTensor(logits).data], [0, 1, 0, 1, 0, 0]);
});

test("tensors that leave the choice open, or are none, are refused", async () => {
  const tensor = { data: new Uint8Array(18), dims: [1, 3, 2, 3] };
  const choice = ["INVALID_OPTION choice", /iou_scores/] as const;
  await rejectsWith(() => maskFromTensor(tensor), ...choice);
  await rejectsWith(() => maskFromTensor(tensor, { index: 3 }), ...choice);
  const refused: Refused[] = [
    [() => maskFromTensor(tensor, { scores: [1, 2] }), "WRONG_LENGTH choice.scores", /2 scores/],
    [() => maskFromTensor({ data: new Uint8Array(17), dims: [1, 3, 2, 3] }), "WRONG_LENGTH tensor.data", /17 values/],
    [
      () => depthFromTensor({ data: new Uint8Array(6), dims: [2, 3] }),
      "EIGHT_BIT_DEPTH tensor.data",
      /predicted_depth/,
    ],
    [() => depthFromTensor({ data: new Float32Array(12), dims: [2, 2, 3] }), "WRONG_LENGTH tensor.dims", /2 maps/],
  ];
  for (const each of refused) await rejectsWith(...each);
});

test("depth comes from a tensor as it is", () => {
  for (const dims of [
    [height, width],
    [1, height, width],
    [1, 1, height, width],
  ]) {
    assert.deepEqual(depthFromTensor({ data: view.depth, dims }), depth);
  }
  assert.deepEqual(depthFromTensor({ data: Float64Array.from(view.depth), dims: [height, width] }), depth);
});

test("disparity becomes depth, and what has none becomes no reading", () => {
  forSeeds(10, (random, seed) => {
    const [scale, shift] = [random.between(0.01, 5), random.between(-0.2, 0.2)];
    const relative = { ...depth, data: view.depth.map((z) => (1 / z - shift) / scale) };
    assertNear(depthFromDisparity(relative, { scale, shift }).data, view.depth, seed, 1e-5);
  });
  const strange = { data: Float32Array.of(0, -1, Number.NaN, Number.POSITIVE_INFINITY), width: 2, height: 2 };
  assert.deepEqual([...depthFromDisparity(strange, { scale: 1 }).data], [0, 0, 0, 0]);
});

test("MoGe's point map becomes ours: pixels where they were, and what is invalid not a number", () => {
  const { points, intrinsics, ...rest } = fixtures.moge;
  const data = Float32Array.from(points.flat(), (x) => x ?? Number.POSITIVE_INFINITY);
  const { pointMap, camera: inPixels } = pointMapFromMoge({ ...rest, points: data, intrinsics });
  assert.ok(inPixels !== undefined);
  let readings = 0;
  rest.mask.forEach((isValid, i) => {
    const [x = 0, y = 0, z = 0] = pointMap.data.subarray(3 * i, 3 * i + 3);
    if (!isValid) {
      assert.ok([x, y, z].every(Number.isNaN));
      return;
    }
    readings += 1;
    const pixel = [(inPixels.fx * x) / z + inPixels.cx, (inPixels.fy * y) / z + inPixels.cy];
    assertNear(pixel, [i % rest.width, Math.floor(i / rest.width)], `pixel ${i}`, 1e-6);
  });
  assert.ok(readings > 50);
  const withoutMask = pointMapFromMoge({ width: rest.width, height: rest.height, points: data });
  assert.deepEqual(withoutMask, { pointMap, camera: undefined });
  const none = pointMapFromMoge({ ...rest, points: data, mask: new Uint8Array(rest.mask.length) });
  assert.ok(none.pointMap.data.every(Number.isNaN));
});

/** Where a camera sees a point: the place in an image of width 1 and height 1, from edge to edge. */
function place(of: { fx: number; fy: number; cx: number; cy: number }, to: { width: number; height: number }) {
  return ([x, y, z]: readonly [number, number, number]) => [
    ((of.fx * x) / z + of.cx + 0.5) / to.width,
    ((of.fy * y) / z + of.cy + 0.5) / to.height,
  ];
}

test("a resized camera sees every point at the same place of the picture", () => {
  forSeeds(20, (random, seed) => {
    const to = { width: random.whole(1, 900), height: random.whole(1, 900) };
    const there = resizeCamera(camera, { fromWidth: width, fromHeight: height, ...to });
    assert.deepEqual({ width: there.width, height: there.height }, to);
    const point = [random.between(-1, 1), random.between(-1, 1), random.between(0.5, 4)] as const;
    assertNear(place(there, to)(point), place(camera, view)(point), seed);
    const back = resizeCamera(there, { ...view, fromWidth: to.width, fromHeight: to.height });
    assertNear([back.fx, back.fy, back.cx, back.cy], Object.values(camera), seed);
  });
  const K = [camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1];
  const size = { fromWidth: width, fromHeight: height, width: 80, height: 60 };
  assert.deepEqual(resizeCamera({ K }, size), resizeCamera(camera, size));
  const fovYDeg = (360 / Math.PI) * Math.atan(height / 2 / 100);
  const { fx, fy, cx, cy } = resizeCamera({ fovYDeg }, size);
  assertNear([fx, fy, cx, cy], [50, 50, 39.5, 29.5], "field of view");
});

test("resized pixels are old pixels, each its nearest", () => {
  forSeeds(20, (random, seed) => {
    const to = { width: random.whole(1, 60), height: random.whole(1, 60) };
    const image = { data: Uint16Array.from({ length: 35 }, (_, i) => i), width: 7, height: 5 };
    const { data } = resizeDepth(image, to);
    assert.ok(data instanceof Uint16Array);
    data.forEach((found, i) => {
      // The new pixel's centre, in pixels of the old image from its edge.
      const u = (((i % to.width) + 0.5) / to.width) * 7;
      const v = ((Math.floor(i / to.width) + 0.5) / to.height) * 5;
      const off = Math.max(Math.abs((found % 7) + 0.5 - u), Math.abs(Math.floor(found / 7) + 0.5 - v));
      assert.ok(off <= 0.5 + 1e-9, `${seed}: pixel ${i} is ${off} from its source`);
    });
  });
  assert.deepEqual(resizeMask(mask, view), mask);
});

test("what is resized or cropped, camera and all, is the same scene", async () => {
  const aligner = await createAligner();
  const size = { width: 2 * width, height: 2 * height };
  const large = {
    depth: resizeDepth(depth, size),
    mask: resizeMask(mask, size),
    camera: resizeCamera(camera, { fromWidth: width, fromHeight: height, ...size }),
    mesh,
  };
  const box = maskBox(large.mask, { marginPx: 20 });
  assert.ok(box.width < size.width && box.height < size.height);
  const inputs = { full: { depth, mask, camera, mesh }, large, part: cropInput(large, box) };
  for (const [name, input] of Object.entries(inputs)) {
    const { metrics } = await aligner.evaluate(input, truth);
    assert.ok((metrics.iou ?? 0) > 0.97, `${name}: iou ${metrics.iou}`);
    assert.ok((metrics.depthMaeMm ?? 9) < 1, `${name}: depth ${metrics.depthMaeMm} mm`);
    assert.ok((metrics.centerDriftPx ?? 9) < 0.3, `${name}: ${metrics.centerDriftPx} px`);
  }
  // A crop of the exact image is the exact scene: half a pixel more would show.
  const exact = await aligner.evaluate(cropInput(inputs.full, maskBox(mask, { marginPx: 5 })), truth);
  assert.ok((exact.metrics.centerDriftPx ?? 9) < 0.05, `${exact.metrics.centerDriftPx} px`);
  assert.ok((exact.metrics.depthMaeMm ?? 9) < 0.01, `${exact.metrics.depthMaeMm} mm`);
});

test("a crop holds the pixels of its box, and everything else of the input", () => {
  const points = { data: Float32Array.from({ length: 36 }, (_, i) => i), width: 4, height: 3 };
  const box = { left: 1, top: 2, width: 2, height: 1 };
  const input = { pointMap: points, mask: { data: Uint8Array.from({ length: 12 }, (_, i) => i), width: 4, height: 3 } };
  const { pointMap, mask: part, ...rest } = cropInput({ ...input, mesh, seed: 3 }, box);
  assert.deepEqual(rest, { mesh, seed: 3 });
  assert.deepEqual(part, { data: Uint8Array.of(9, 10), width: 2, height: 1 });
  assert.deepEqual([...pointMap.data], [27, 28, 29, 30, 31, 32]);
  assert.deepEqual(maskBox({ ...input.mask, data: Uint8Array.of(0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0) }), {
    left: 1,
    top: 1,
    width: 2,
    height: 2,
  });
});

test("sizes that do not go together are refused", async () => {
  const small = resizeMask(mask, { width: 8, height: 6 });
  const whole = { left: 0, top: 0, width, height };
  const refused: Refused[] = [
    [() => cropInput({ depth, mask: small }, whole), "SIZE_MISMATCH input.mask", /8 × 6 pixels, expected 160 × 120/],
    [() => cropInput({ depth }, { ...whole, left: 1 }), "SIZE_MISMATCH box", /within/],
    [() => maskBox({ data: new Uint8Array(4), width: 2, height: 2 }), "EMPTY_MASK mask", /no non-zero pixel/],
    [
      () => resizeCamera({ ...camera, fx: 0 }, { fromWidth: 1, fromHeight: 1, width: 2, height: 2 }),
      "INVALID_CAMERA camera.fx",
      /above 0/,
    ],
    [
      () =>
        resizeCamera({ K: [600, 0, 0, 0, 600, 0, 320, 240, 1] }, { fromWidth: 1, fromHeight: 1, width: 2, height: 2 }),
      "INVALID_CAMERA camera.K",
      /transpose/,
    ],
    [() => depthFromDisparity(depth, { scale: Number.NaN }), "INVALID_ARGUMENT calibration.scale", /finite/],
  ];
  for (const each of refused) await rejectsWith(...each);
});
