/** Tensors, depth, point maps, and images of another size, with the camera kept right. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { type CameraInput, createAligner, type PinholeCamera } from "sim3align";
import { correctDepth, cropInput, fromTensor, pointMapFromMoge, resizeInput } from "sim3align/conventions";
import { fixtures } from "../support/conventions.js";
import { type Refused, rejectsWith } from "../support/errors.js";
import { fixture } from "../support/files.js";
import { assertNear, forSeeds } from "../support/random.js";
import { mesh, truth, view } from "../support/scene.js";

const { width, height, camera } = view;
const depth = { data: view.depth, width, height };
const mask = { data: view.mask, width, height };

test("a mask is chosen from a tensor by its number or its score; depth comes as it is", () => {
  const data = Uint8Array.of(1, 0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1);
  const tensor = { data, dims: [1, 3, 2, 3] };
  const scores = { data: Float32Array.of(0.2, 0.9, 0.4), dims: [1, 1, 3] };
  assert.deepEqual([...fromTensor(tensor, "mask", { scores }).data], [1, 1, 0, 0, 0, 0]);
  assert.deepEqual([...fromTensor(tensor, "mask", { scores: [0.2, 0.1, 0.4] }).data], [0, 0, 0, 0, 1, 1]);
  const first = { data: Uint8Array.of(1, 0, 0, 0, 0, 0), width: 3, height: 2 };
  assert.deepEqual(fromTensor(tensor, "mask", { index: 0 }), first);
  assert.deepEqual([...fromTensor({ data: [true, false], dims: [1, 2] }, "mask").data], [1, 0]);
  const logits = { data: Float32Array.of(-3, 0.1, Number.NaN, 7, 0, -0), dims: [1, 1, 2, 3] };
  assert.deepEqual([...fromTensor(logits, "mask").data], [0, 1, 0, 1, 0, 0]);
  for (const dims of [
    [height, width],
    [1, height, width],
    [1, 1, height, width],
  ]) {
    for (const values of [view.depth, Float64Array.from(view.depth)]) {
      assert.deepEqual(fromTensor({ data: values, dims }, "depth"), depth);
    }
  }
});

test("disparity becomes depth, and what has none becomes no reading", () => {
  forSeeds(10, (random, seed) => {
    const [scale, shift] = [random.between(0.01, 5), random.between(-0.2, 0.2)];
    const relative = { ...depth, data: view.depth.map((z) => scale / z - shift) };
    const ofStereo = { depthKind: "affine-invariant-disparity", scale, shift } as const;
    assertNear(correctDepth(relative, ofStereo).data, view.depth, seed, 1e-5);
  });
  const strange = { data: Float32Array.of(0, -1, Number.NaN, Number.POSITIVE_INFINITY), width: 2, height: 2 };
  assert.deepEqual([...correctDepth(strange, { depthKind: "affine-invariant-disparity" }).data], [1000, 1000, 0, 0]);
  assert.deepEqual([...correctDepth(strange, { depthKind: "metric", scale: 2 }).data], [0, 0, 0, 0]);
});

test("MoGe's point map becomes ours: pixels where they were, and what is invalid not a number", () => {
  const { points, intrinsics, ...rest } = fixtures.moge;
  const data = Float32Array.from(points.flat(), (x) => x ?? Number.POSITIVE_INFINITY);
  const { pointMap, camera: inPixels } = pointMapFromMoge({ ...rest, points: data, intrinsics });
  assert.ok(inPixels !== undefined && rest.mask.filter(Boolean).length > 50);
  for (const [i, isValid] of rest.mask.entries()) {
    const [x = 0, y = 0, z = 0] = pointMap.data.subarray(3 * i, 3 * i + 3);
    if (isValid) {
      const pixel = [(inPixels.fx * x) / z + inPixels.cx, (inPixels.fy * y) / z + inPixels.cy];
      assertNear(pixel, [i % rest.width, Math.floor(i / rest.width)], `pixel ${i}`, 1e-6);
    } else assert.ok([x, y, z].every(Number.isNaN));
  }
  const { width, height } = rest;
  assert.deepEqual(pointMapFromMoge({ width, height, points: data }), { pointMap, camera: undefined });
  const none = pointMapFromMoge({ ...rest, points: data, mask: new Uint8Array(rest.mask.length) });
  assert.ok(none.pointMap.data.every(Number.isNaN));
});

type Camera = { fx: number; fy: number; cx: number; cy: number };

/** The projection of a point: its place in an image of width 1 and height 1, from edge to edge. */
const place = (of: Camera, to: { width: number; height: number }, [x = 0, y = 0, z = 1]: readonly number[]) => [
  ((of.fx * x) / z + of.cx + 0.5) / to.width,
  ((of.fy * y) / z + of.cy + 0.5) / to.height,
];

test("a resized camera sees every point at the same place of the picture", () => {
  const resized = (camera: CameraInput, to: { width: number; height: number }) =>
    resizeInput({ depth, camera }, to).camera as PinholeCamera;
  forSeeds(20, (random, seed) => {
    const to = { width: random.whole(1, 900), height: random.whole(1, 900) };
    // Reduced by an even number, no sample is in the middle of its block: see the next test.
    if ([width / to.width, height / to.height].some((n) => n % 2 === 0)) return;
    const there = resized(camera, to);
    assert.deepEqual([there.width, there.height], [to.width, to.height]);
    const point = [...random.list(2, -1, 1), random.between(0.5, 4)];
    assertNear(place(there, to, point), place(camera, view, point), seed);
  });
  const K = [camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1];
  const size = { width: 100, height: 75 };
  assert.deepEqual(resized({ K }, size), resized(camera, size));
  assert.deepEqual(resizeInput({ camera: { ...camera, width, height } }, size).camera, resized(camera, size));
  const fovYDeg = (360 / Math.PI) * Math.atan(height / 2 / 100);
  const { fx, fy, cx, cy } = resized({ fovYDeg }, size);
  assertNear([fx, fy, cx, cy], [62.5, 62.5, 49.5, 37], "field of view");
});

test("after a reduction by a whole number, every pixel has the ray of the pixel it was", () => {
  for (const n of [2, 3, 4, 8]) {
    const size = { width: 24 * n, height: 2 * n };
    const columns = {
      data: Float32Array.from({ length: size.width * size.height }, (_, i) => i % size.width),
      ...size,
    };
    const input = { depth: columns, camera: { fx: 50, fy: 50, cx: 11.25, cy: 1 } };
    const { depth, camera: of } = resizeInput(input, { width: 24, height: 2 });
    const { fx, cx } = of as PinholeCamera;
    for (let u = 0; u < 24; u++) assertNear([(u - cx) / fx], [((depth.data[u] ?? 0) - 11.25) / 50], `by ${n}`, 1e-9);
  }
});

test("resized pixels are old pixels, each its nearest", () => {
  forSeeds(20, (random, seed) => {
    const to = { width: random.whole(1, 60), height: random.whole(1, 60) };
    const image = { data: Uint16Array.from({ length: 35 }, (_, i) => i), width: 7, height: 5 };
    const { data } = resizeInput({ depth: image }, to).depth;
    assert.ok(data instanceof Uint16Array);
    data.forEach((found, i) => {
      // The new pixel's centre, in pixels of the old image from its edge.
      const u = (((i % to.width) + 0.5) / to.width) * 7;
      const v = ((Math.floor(i / to.width) + 0.5) / to.height) * 5;
      const off = Math.max(Math.abs((found % 7) + 0.5 - u), Math.abs(Math.floor(found / 7) + 0.5 - v));
      assert.ok(off <= 0.5 + 1e-9, `${seed}: pixel ${i} is ${off} from its source`);
    });
  });
  const points = { data: Float32Array.from({ length: 12 }, (_, i) => i), width: 2, height: 2 };
  const part = resizeInput({ mask, pointMap: points, image: points, seed: 3 } as never, { width: 1, height: 2 });
  assert.deepEqual(
    { ...(part as object), mask: 0 },
    {
      ...{
        mask: 0,
        pointMap: { data: Float32Array.of(3, 4, 5, 9, 10, 11), width: 1, height: 2 },
        image: points,
        seed: 3,
      },
    },
  );
  assert.deepEqual(resizeInput({ mask }, view).mask, mask);
});

test("a cropped input is the same scene: half a pixel more would show", async () => {
  const aligner = await createAligner();
  const cropped = cropInput({ depth, mask, camera, mesh }, { marginPx: 5 });
  assert.ok(cropped.depth.width < width && cropped.depth.height < height);
  const { metrics } = await aligner.evaluate(cropped, truth);
  assert.ok((metrics.iou ?? 0) > 0.97 && (metrics.depthMaeM ?? 9) < 1e-5, JSON.stringify(metrics));
  assert.ok((metrics.centerDriftPx ?? 9) < 0.05, JSON.stringify(metrics));
});

test("a camera keeps what it states besides, and its own size is that of its intrinsics", () => {
  const others = { depthScale: 0.1, focalUncertainty: 0.05 };
  const half = { width: width / 2, height: height / 2 };
  const twice = {
    ...resizeInput({ camera: { ...camera, width, height } }, { width: 2 * width, height: 2 * height }).camera,
  };
  const region = { left: 3, top: 2, width: 50, height: 40 };
  const cropped = cropInput({ depth, camera }, region).camera as PinholeCamera;
  assert.deepEqual(cropInput({ depth, camera: { ...twice, ...others } }, region).camera, { ...cropped, ...others });
  assert.deepEqual(resizeInput({ depth, camera: { ...camera, ...others } }, half).camera, {
    ...resizeInput({ depth, camera }, half).camera,
    ...others,
  });
});

test("a crop holds the pixels of its box, of the photo too, and everything else of the input", () => {
  const size = { width: 4, height: 3 };
  const points = { data: Float32Array.from({ length: 36 }, (_, i) => i), ...size };
  const labels = { data: Uint8Array.from({ length: 12 }, (_, i) => i), ...size };
  const images = [3, 4].map((channels) => ({ data: Uint8Array.from({ length: 12 * channels }, (_, i) => i), ...size }));
  const box = { left: 1, top: 2, width: 2, height: 1 };
  for (const [k, image] of images.entries()) {
    const input = { pointMap: points, mask: labels, image, mesh, seed: 3 };
    const { pointMap, mask: part, image: photo, ...rest } = cropInput(input, box);
    assert.deepEqual(rest, { mesh, seed: 3 });
    assert.deepEqual(part, { data: Uint8Array.of(9, 10), width: 2, height: 1 });
    assert.deepEqual([...pointMap.data], [27, 28, 29, 30, 31, 32]);
    assert.deepEqual(photo.data, image.data.slice(9 * (3 + k), 11 * (3 + k)));
  }
  const marked = { ...labels, data: Uint8Array.of(0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0) };
  const data = Uint8Array.of(0, 1, 1, 0);
  assert.deepEqual(cropInput({ mask: marked }, { marginPx: 0 }).mask, { data, width: 2, height: 2 });
});

test("tensors that leave the choice open, and sizes that do not go together, are refused", async () => {
  const tensor = { data: new Uint8Array(18), dims: [1, 3, 2, 3] };
  const { mask: small } = resizeInput({ mask }, { width: 8, height: 6 });
  const whole = { left: 0, top: 0, width, height };
  const refused: Refused[] = [
    [() => fromTensor(tensor, "mask"), "INVALID_OPTION choice", /iou_scores/],
    [() => fromTensor(tensor, "mask", { scores: [1, 2] }), "WRONG_LENGTH choice.scores", /2 scores/],
    [
      () => fromTensor({ data: new Uint8Array(6), dims: [2, 3] }, "depth"),
      "EIGHT_BIT_DEPTH tensor.data",
      /predicted_depth/,
    ],
    [() => cropInput({ depth, mask: small }, whole), "SIZE_MISMATCH input.mask", /8 × 6 pixels, expected 160 × 120/],
    [() => fromTensor({ ...tensor, data: new Uint8Array(17) }, "mask"), "WRONG_LENGTH tensor.data", /17 values/],
    [
      () => cropInput({ mask: { data: new Uint8Array(4), width: 2, height: 2 } }, { marginPx: 1 }),
      ...(["EMPTY_MASK input.mask", /no non-zero pixel/] as const),
    ],
    [() => resizeInput({ camera }, { width: 8, height: 6 }), "INVALID_ARGUMENT input.camera.width"],
    [() => cropInput({ depth }, { ...whole, left: 1 }), "SIZE_MISMATCH box", /within/],
    [() => cropInput({ depth, cameraFile: camera }, whole), "INVALID_ARGUMENT cameraFile", /readCamera/],
    // Bytes of a file cannot be cropped, and the whole photo would not belong to the part.
    [() => cropInput({ depth, image: fixture("photo.png") as never }, whole), "INVALID_ARGUMENT input.image"],
    [
      () => correctDepth(depth, { depthKind: "metric", scale: Number.NaN }),
      ...(["INVALID_ARGUMENT correction.scale", /finite/] as const),
    ],
    [() => correctDepth(depth, { depthKind: "ray-distance" }), "INVALID_ARGUMENT correction.camera"],
  ];
  for (const each of refused) await rejectsWith(...each);
});
