/** Every form of depth, mask, camera and mesh gives the result that plain typed arrays give. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { type AlignInput, type CameraFileInput, createAligner, type Evaluation } from "sim3align";
import { codesOf, rejectsWith } from "../support/errors.js";
import { cocoRle, glb, gltfBuffer, gltfJson, maskPng, npy, obj, png } from "../support/files.js";
import { withoutTimes } from "../support/results.js";
import { input, mesh, truth, view } from "../support/scene.js";

const { width, height, depth, mask, camera } = view;
const aligner = await createAligner();
const { depthUnit: unit, ...reference } = await aligner.evaluate(input, truth);
const withoutSize = { depth: { data: depth, width, height }, mask, camera, mesh };

/** Within what rounding depth to a tenth of a millimetre does. */
function assertClose(found: Evaluation, tolerance: number): void {
  for (const [name, value] of Object.entries(reference.metrics)) {
    const other = found.metrics[name as keyof typeof found.metrics];
    assert.ok(Math.abs((other ?? Number.NaN) - (value ?? Number.NaN)) <= tolerance, `${name}: ${other}, not ${value}`);
  }
}

/** The result without the unit that was taken, which tells the forms apart. */
async function evaluated(input: AlignInput): Promise<Evaluation> {
  const { depthUnit: _, ...evaluation } = await aligner.evaluate(input, truth);
  return evaluation;
}

test("the unit that was taken is told", () => assert.equal(unit, "metres (float values, assumed)"));

/** A form that loses nothing. */
function same(name: string, make: () => Partial<AlignInput>): void {
  test(name, async () => {
    const changed = { ...withoutSize, ...make() } as AlignInput;
    assert.deepEqual(await evaluated(changed), reference);
  });
}

const arrayBuffer = (bytes: Uint8Array) => Uint8Array.from(bytes).buffer;
const tenths = Uint16Array.from(depth, (z) => Math.round(10_000 * z));

same("depth: with its size", () => ({}));
same("depth: bytes of a .npy file", () => ({ depth: npy(depth, height, width) }));
same("depth: an ArrayBuffer with a .npy file", () => ({ depth: arrayBuffer(npy(depth, height, width)) }));
same("depth: a Blob with a .npy file", () => ({ depth: new Blob([arrayBuffer(npy(depth, height, width))]) }));
same("depth: a file and its size", () => ({ depth: npy(depth, height, width), width, height }));
same("depth: floats in millimetres", () => ({
  depth: { data: depth.map((z) => z * 1024), width, height },
  depthScale: 1 / 1024,
}));
same("depth: 0, negative, NaN and infinite values are no reading", () => {
  const bad = [0, -1, Number.NaN, Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
  const outside = depth.map((z, i) => (mask[i] === 0 && i % 3 === 0 ? (bad[i % bad.length] ?? 0) : z));
  return { depth: { data: outside, width, height } };
});

test("depth: whole numbers, as an array, as PNG and as .npy, all alike", async () => {
  const asArray = await evaluated({ ...withoutSize, depth: { data: tenths, width, height }, depthScale: 0.0001 });
  assertClose(asArray, 0.05);
  for (const file of [png(tenths, width, height), npy(tenths, height, width)]) {
    assert.deepEqual(await evaluated({ ...withoutSize, depth: file, depthScale: 0.0001 }), asArray);
  }
  const bopCamera = { cam_K: [camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1], depth_scale: 0.1 };
  const { camera: _, ...withoutCamera } = withoutSize;
  const byCamera = {
    ...withoutCamera,
    depth: png(tenths, width, height),
    cameraFile: { "7": bopCamera, "8": { ...bopCamera, depth_scale: 1 } },
    imageId: 7,
  };
  assert.deepEqual(await evaluated(byCamera), asArray, "the camera file's scale");
  const bare = { ...byCamera, depth: tenths, width, height };
  assert.deepEqual(await evaluated(bare), asArray, "the camera file's scale for an array");
  const floats = { ...byCamera, depth: npy(depth, height, width) };
  assert.deepEqual(await evaluated(floats), reference, "floats are metres whatever the camera file says");
});

test("depth: whole numbers are millimetres where nothing is said", async () => {
  const millimetres = Uint16Array.from(depth, (z) => Math.round(1000 * z));
  const asArray = await evaluated({ ...withoutSize, depth: { data: millimetres, width, height } });
  assertClose(asArray, 0.5);
  assert.deepEqual(await evaluated({ ...withoutSize, depth: png(millimetres, width, height) }), asArray);
});

same("mask: other values than 1", () => ({ mask: mask.map((m) => 200 * m) }));
same("mask: a clamped array", () => ({ mask: Uint8ClampedArray.from(mask) }));
same("mask: with its size", () => ({ mask: { data: mask, width, height } }));
same("mask: an ArrayBuffer of pixels", () => ({ mask: arrayBuffer(mask) }));
same("mask: bytes of a PNG", () => ({
  mask: maskPng(mask, width, height),
}));
same("mask: a Blob with a PNG", () => ({ mask: new Blob([arrayBuffer(png(mask, width, height))]) }));
same("mask: bytes of a .npy file", () => ({ mask: npy(mask, height, width) }));
same("mask: COCO RLE", () => ({ mask: cocoRle(mask, width, height) }));
same("mask: bytes of JSON with COCO RLE", () => ({ mask: Buffer.from(JSON.stringify(cocoRle(mask, width, height))) }));
same("mask: twice the size, resized", () => {
  const data = Uint8Array.from({ length: 4 * width * height }, (_, i) => {
    const [u, v] = [i % (2 * width), Math.floor(i / (2 * width))];
    return mask[Math.floor(v / 2) * width + Math.floor(u / 2)] ?? 0;
  });
  return { mask: { data, width: 2 * width, height: 2 * height }, resizeMask: "nearest" };
});

const K = [camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1];
same("camera: with the image's size", () => ({ camera: { ...camera, width, height } }));
same("camera: K", () => ({ camera: { K } }));
same("camera: K as a typed array", () => ({ camera: { K: Float64Array.from(K) } }));
same("camera: K in rows", () => ({ camera: { K: [K.slice(0, 3), K.slice(3, 6), K.slice(6)] } }));
const fileOf = (cameraFile: CameraFileInput) => () => ({ camera: undefined, cameraFile });
same("camera file: text", fileOf(JSON.stringify({ ...camera, width, height })));
same("camera file: bytes", fileOf(Buffer.from(JSON.stringify(camera))));
same("camera file: a Blob", fileOf(new Blob([JSON.stringify(camera)])));
same("camera file: ROS CameraInfo", fileOf({ width, height, k: K, d: [0, 0, 0, 0, 0], distortion_model: "" }));
same("camera file: what readCamera made of it", () => ({
  camera: { ...camera, width, height, warnings: [] },
}));

test("camera: a vertical field of view", async () => {
  const fovYDeg = (360 / Math.PI) * Math.atan(height / 2 / camera.fy);
  const { metrics } = await evaluated({ ...withoutSize, camera: { fovYDeg } });
  assert.ok((metrics.iou ?? 0) > 0.95, `${metrics.iou}`);
  const { camera: _, ...rest } = withoutSize;
  const fromText = await evaluated({ ...rest, cameraFile: JSON.stringify({ fovYDeg }) });
  assert.deepEqual(fromText.metrics, metrics);
});

test("camera file: lens distortion is warned of", async () => {
  const cameraFile = { width, height, k: K, d: [0.1, -0.2, 0, 0, 0], distortion_model: "plumb_bob" };
  const { camera: _, ...rest } = withoutSize;
  const { warnings, metrics } = await evaluated({ ...rest, cameraFile });
  assert.deepEqual(codesOf(warnings), ["CAMERA_NOT_PINHOLE"]);
  assert.match(warnings[0]?.message ?? "", /distortion/);
  assert.deepEqual(metrics, reference.metrics);
});

same("mesh: 16-bit indices", () => ({ mesh: { ...mesh, indices: Uint16Array.from(mesh.indices) } }));
same("mesh: bytes of a GLB", () => ({ mesh: glb(mesh) }));
same("mesh: a Blob with a GLB", () => ({ mesh: new Blob([arrayBuffer(glb(mesh))]) }));
same("mesh: bytes of an OBJ, named", () => ({ mesh: { bytes: obj(mesh), format: "obj" } }));
same("mesh: bytes of an OBJ, recognised", () => ({ mesh: obj(mesh) }));
same("mesh: a .gltf and its buffer", () => ({
  mesh: {
    bytes: Buffer.from(JSON.stringify(gltfJson(mesh, {}, { uri: "mesh.bin" }))),
    resources: { "mesh.bin": gltfBuffer(mesh) },
  },
}));
same("mesh: a GLB whose node moves it", () => {
  const shrunk = { positions: mesh.positions.map((x) => x / 2), indices: mesh.indices };
  return { mesh: glb(shrunk, { scale: [2, 2, 2] }) };
});

test("mesh: triangles without indices, null for indices", async () => {
  const corners = Float32Array.from({ length: 3 * mesh.indices.length }, (_, i) => {
    return mesh.positions[3 * (mesh.indices[Math.floor(i / 3)] ?? 0) + (i % 3)] ?? 0;
  });
  for (const indices of [undefined, null]) {
    const soup = { ...withoutSize, mesh: { positions: corners, indices } };
    assertClose(await evaluated(soup), 1e-3);
  }
});

test("a point map takes the place of depth and camera", async () => {
  const data = Float32Array.from({ length: 3 * width * height }, (_, i) => {
    const pixel = Math.floor(i / 3);
    const z = depth[pixel] ?? 0;
    const [u, v] = [pixel % width, Math.floor(pixel / width)];
    return [((u - camera.cx) * z) / camera.fx, ((v - camera.cy) * z) / camera.fy, z][i % 3] ?? 0;
  });
  assertClose(await evaluated({ pointMap: { data, width, height }, mask, mesh }), 0.02);
  assertClose(await evaluated({ pointMap: data, width, height, mask, mesh }), 0.02);
  assertClose(await evaluated({ pointMap: data, width, height, mask, mesh, camera }), 0.02);
  const both = { pointMap: data, depth, width, height, mask, mesh } as unknown as AlignInput;
  const expected = ["INVALID_ARGUMENT depth", /not both/] as const;
  await rejectsWith(() => evaluated(both), ...expected);
});

test("align takes files as well", async () => {
  const files = {
    depth: npy(depth, height, width),
    mask: png(mask, width, height),
    cameraFile: JSON.stringify(camera),
    mesh: glb(mesh),
  };
  assert.deepEqual(withoutTimes(await aligner.align(files)), withoutTimes(await aligner.align(input)));
});
