/** Every form of depth, mask, camera, mesh and photo gives the result that plain typed arrays give. */
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  type AlignInput,
  type Alignment,
  type CameraFileInput,
  createAligner,
  type Evaluation,
  type MeshArrays,
  type SceneInput,
} from "sim3align";
import { readCamera, readDepth, readMesh } from "sim3align/formats";
import { codesOf } from "../support/errors.js";
import { cocoRle, glb, glbOf, gltfBuffer, gltfJson, maskPng, npy, obj, png, texturedJson } from "../support/files.js";
import { assertNear } from "../support/random.js";
import { input, mesh, truth, view } from "../support/scene.js";
import { deflated, zip } from "../support/zip.js";

const { width, height, depth, mask, camera } = view;
const aligner = await createAligner();
const plain = { depth: { data: depth, width, height }, mask, camera, mesh };

type Stretch = NonNullable<Alignment["proportions"]>;

/** The result without how the files were read, which tells the forms apart. */
async function evaluated(changes: object): Promise<Evaluation> {
  const {
    depthUnit: _,
    maskReading: __,
    ...evaluation
  } = await aligner.evaluate({ ...plain, ...changes } as AlignInput, truth);
  return evaluation;
}

const reference = await evaluated({});

/** Whether metrics are as close as rounding of the depth leaves them. */
function assertClose(found: Evaluation, tolerance: number): void {
  for (const [name, value] of Object.entries(reference.metrics)) {
    const other = found.metrics[name as keyof typeof found.metrics];
    assert.ok(Math.abs((other ?? Number.NaN) - (value ?? Number.NaN)) <= tolerance, `${name}: ${other}, not ${value}`);
  }
}

const arrayBuffer = (bytes: Uint8Array) => Uint8Array.from(bytes).buffer;
const blobOf = (bytes: Uint8Array) => new Blob([arrayBuffer(bytes)]);
const shared = new Float32Array(new SharedArrayBuffer(depth.byteLength));
shared.set(depth);
const readings = [0, -1, Number.NaN, Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
const size = { width, height };
const depthFile = npy(depth, height, width);
const rle = cocoRle(mask, width, height);
const twice = Uint8Array.from({ length: 4 * width * height }, (_, i) => {
  const [u, v] = [i % (2 * width), Math.floor(i / (2 * width))];
  return mask[Math.floor(v / 2) * width + Math.floor(u / 2)] ?? 0;
});
const K = [camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1];
const fileOf = (cameraFile: CameraFileInput) => ({ camera: undefined, cameraFile });
const json = JSON.stringify({ ...camera, ...size });
const shrunk = { positions: mesh.positions.map((x) => x / 2), indices: mesh.indices };

/** Forms that lose nothing. */
const forms: Record<string, object> = {
  "depth with its size beside it": { depth, ...size },
  "depth on shared memory": { depth: { data: shared, ...size } },
  "depth: bytes of a .npy file": { depth: depthFile },
  "depth: floats in another unit": { depth: { data: depth.map((z) => z * 1024), ...size }, depthScale: 1 / 1024 },
  "depth: 0, negative, NaN and infinite values are no reading": {
    depth: { data: depth.map((z, i) => (mask[i] === 0 && i % 3 === 0 ? (readings[i % 5] ?? 0) : z)), ...size },
  },
  "mask: other values than 1": { mask: mask.map((m) => 200 * m) },
  "mask: a clamped array": { mask: Uint8ClampedArray.from(mask) },
  "mask: an ArrayBuffer of pixels": { mask: arrayBuffer(mask) },
  "mask: bytes of a PNG": { mask: maskPng(mask, width, height) },
  "mask: bytes of a .npy file": { mask: npy(mask, height, width) },
  "mask: COCO RLE": { mask: rle },
  "mask of twice the size, resized": {
    ...{ mask: { data: twice, width: 2 * width, height: 2 * height }, resizeMask: "nearest" },
  },
  "camera with the image's size": { camera: { ...camera, ...size } },
  "camera: K": { camera: { K } },
  "camera file: text": fileOf(json),
  "camera file: ROS CameraInfo": fileOf({ ...size, k: K, d: [0, 0, 0, 0, 0], distortion_model: "" }),
  "depth: 64-bit numbers": { depth: Float64Array.from(depth), ...size },
  "mesh: 16-bit indices": { mesh: { ...mesh, indices: Uint16Array.from(mesh.indices) } },
  "mesh: bytes of an OBJ, named": { mesh: { bytes: obj(mesh), format: "obj" } },
  "mesh: a .gltf and its buffer": {
    mesh: {
      bytes: Buffer.from(JSON.stringify(gltfJson(mesh, {}, { uri: "mesh.bin" }))),
      resources: { "mesh.bin": gltfBuffer(mesh) },
    },
  },
  "mesh: a GLB whose node moves it": { mesh: glb(shrunk, { scale: [2, 2, 2] }) },
};

for (const [name, changes] of Object.entries(forms)) {
  test(name, async () => assert.deepEqual(await evaluated(changes), reference));
}

test("depth: whole numbers, as an array, as PNG and as .npy, in a unit that is stated or millimetres", async () => {
  const tenths = Uint16Array.from(depth, (z) => Math.round(10_000 * z));
  const asArray = await evaluated({ depth: { data: tenths, ...size }, depthScale: 0.0001 });
  assertClose(asArray, 0.05);
  for (const file of [png(tenths, width, height), npy(tenths, height, width)]) {
    assert.deepEqual(await evaluated({ depth: file, depthScale: 0.0001 }), asArray);
  }
  const entry = { cam_K: K, depth_scale: 0.1 };
  const byCamera = { ...fileOf({ "7": entry, "8": { ...entry, depth_scale: 1 } }), imageId: 7 };
  const byFile = await evaluated({ ...byCamera, depth: png(tenths, width, height) });
  assert.deepEqual(byFile, asArray, "the camera file's scale");
  assert.deepEqual(await evaluated({ ...byCamera, depth: tenths, ...size }), asArray, "for an array, too");
  assert.deepEqual(await evaluated({ ...byCamera, depth: depthFile }), reference, "floats are metres all the same");
  const millimetres = Uint16Array.from(depth, (z) => Math.round(1000 * z));
  const assumed = await evaluated({ depth: { data: millimetres, ...size } });
  assertClose(assumed, 0.5);
  assert.deepEqual(await evaluated({ depth: png(millimetres, width, height) }), assumed);
});

test("camera: a vertical field of view, and lens distortion, which is warned of", async () => {
  const fovYDeg = (360 / Math.PI) * Math.atan(height / 2 / camera.fy);
  const { metrics } = await evaluated({ camera: { fovYDeg } });
  assert.ok((metrics.iou ?? 0) > 0.95, `${metrics.iou}`);
  assert.deepEqual((await evaluated(fileOf(JSON.stringify({ fovYDeg })))).metrics, metrics);
  const distorted = { ...size, k: K, d: [0.1, -0.2, 0, 0, 0], distortion_model: "plumb_bob" };
  const { warnings, ...found } = await evaluated(fileOf(distorted));
  assert.deepEqual([codesOf(warnings), found.metrics], [["CAMERA_NOT_PINHOLE"], reference.metrics]);
  assert.match(warnings[0]?.message ?? "", /distortion/);
});

test("camera: nine numbers in an .npz file", async () => {
  const file = zip([deflated("depth.npy", depthFile), deflated("cam_K.npy", npy(Float32Array.from(K), 1, 9))]);
  assert.deepEqual((await evaluated({ camera: undefined, depth: file })).metrics, reference.metrics);
});

test("arrays of an .npz file that are no depth are told from it by their names, sizes and types", async () => {
  const size = [3, 4] as const;
  const matrix = npy(
    Float32Array.from({ length: 16 }, (_, i) => i + 1),
    4,
    4,
  );
  const values = Float32Array.from({ length: 3 * 12 }, (_, i) => {
    const [pixel, z] = [Math.floor(i / 3), 2 + Math.floor(i / 3) / 33];
    return [((pixel % 4) - 1) * z, (Math.floor(pixel / 4) - 1) * z, z][i % 3] ?? 0;
  });
  const points = Buffer.from(
    Buffer.from(npy(values, 3, 12))
      .toString("latin1")
      .replace("(3, 12), }  ", "(3, 4, 3), }"),
    "latin1",
  );
  const flags = npy(
    Uint8Array.from({ length: 12 }, (_, i) => i % 2),
    ...size,
  );
  const valid = Buffer.from(Buffer.from(flags).toString("latin1").replace("|u1", "|b1"), "latin1");
  const long = Buffer.concat([Buffer.from("\x93NUMPY\x01\x00\x40\x1f", "latin1"), Buffer.alloc(8000, "(")]);
  const depthOf = async (files: Record<string, Uint8Array>) =>
    (await readDepth(zip(Object.entries(files).map(([name, bytes]) => deflated(`${name}.npy`, bytes))))).data;
  const z = values.filter((_, i) => i % 3 === 2);
  for (const name of ["pose", "intrinsics", "extrinsic"])
    assert.deepEqual(await depthOf({ [name]: matrix, points }), z);
  const found = await depthOf({ mask: flags, depth: npy(z, ...size), valid, records: long });
  assert.deepEqual(
    found,
    z.map((value, i) => (i % 2) * value),
  );
});

test("mesh: triangles without indices, null for indices", async () => {
  const corners = Float32Array.from({ length: 3 * mesh.indices.length }, (_, i) => {
    return mesh.positions[3 * (mesh.indices[Math.floor(i / 3)] ?? 0) + (i % 3)] ?? 0;
  });
  for (const indices of [undefined, null])
    assertClose(await evaluated({ mesh: { positions: corners, indices } }), 1e-3);
});

test("a point map takes the place of depth and camera", async () => {
  const data = Float32Array.from({ length: 3 * width * height }, (_, i) => {
    const pixel = Math.floor(i / 3);
    const z = depth[pixel] ?? 0;
    const [u, v] = [pixel % width, Math.floor(pixel / width)];
    return [((u - camera.cx) * z) / camera.fx, ((v - camera.cy) * z) / camera.fy, z][i % 3] ?? 0;
  });
  const without = { depth: undefined, camera: undefined };
  assertClose(await evaluated({ ...without, pointMap: { data, ...size } }), 0.02);
  assertClose(await evaluated({ ...without, pointMap: data, ...size }), 0.02);
  assertClose(await evaluated({ ...without, pointMap: data, ...size, camera }), 0.02);
});

// Colours of the mesh's vertices, and a photo of them, a little darker.
const vertices = mesh.positions.length / 3;
const colors = Uint8Array.from({ length: 3 * vertices }, (_, i) => (11 * i) % 256);
const opaque = (rgb: Uint8Array, alpha: number) =>
  Uint8ClampedArray.from({ length: (4 * rgb.length) / 3 }, (_, i) =>
    i % 4 === 3 ? alpha : (rgb[3 * Math.floor(i / 4) + (i % 4)] ?? 0),
  );
const withAlpha = opaque(colors, 9);
const rgb = Uint8Array.from({ length: 3 * width * height }, (_, i) => (7 * i + (i % 3) * 50) % 256);
const rgba = opaque(rgb, 77);
const linear = (code: number) => {
  const x = code / 255;
  return x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4;
};

/** Like the class of browsers: its properties are accessors of the prototype. */
class ImageData {}
const values = { data: rgba, ...size, [Symbol.toStringTag]: "ImageData" };
for (const name of Reflect.ownKeys(values)) {
  Object.defineProperty(ImageData.prototype, name, { get: () => values[name as "data"] });
}

test("photo and mesh colours: every form of arrays and files gives the same agreement", async () => {
  const colored = await evaluated({ image: rgb, mesh: { ...mesh, colors } });
  const { colorAgreement } = colored.metrics;
  assert.ok(Math.abs(colorAgreement ?? 0) > 1e-3, `${colorAgreement}`);
  const photo = png(rgb, width, height, 3);
  const images = [rgba, new Uint8Array(rgba), { data: rgb, ...size }, new ImageData(), photo, blobOf(photo)];
  for (const image of images) {
    assert.deepEqual(await evaluated({ image, mesh: { ...mesh, colors } }), colored);
  }
  const meshes: Partial<MeshArrays>[] = [
    { colors: withAlpha },
    { colors: Float32Array.from(colors, (code) => code / 255) },
    { colors: Float32Array.from(colors, linear), colorSpace: "linear" },
    { colors: Float32Array.from(withAlpha, linear), colorSpace: "linear" },
  ];
  for (const form of meshes) assert.deepEqual(await evaluated({ image: rgb, mesh: { ...mesh, ...form } }), colored);
  for (const one of [{ image: rgb }, { mesh: { ...mesh, colors } }]) {
    assert.deepEqual(await evaluated(one), reference, "neither counts without the other");
  }
});

test("a mesh with a texture that can't be read is aligned by its shape, with a warning where there is a photo", async () => {
  const images = [{ uri: "data:image/webp;base64,UklGRgAAAABXRUJQVlA4IA==" }];
  const webp = glbOf(texturedJson(mesh, { source: 0 }, { images }), gltfBuffer(mesh));
  using pool = await createAligner({ workers: 1 });
  for (const [one, mesh] of [
    [aligner, webp],
    [pool, await pool.prepareMesh(webp)],
  ] as const) {
    const { warnings, metrics } = await one.evaluate({ ...input, image: rgb, mesh }, truth);
    assert.deepEqual([codesOf(warnings), metrics], [["COLORS_NOT_READ"], reference.metrics]);
    assert.match(warnings[0]?.message ?? "", /WebP.*gltf-transform/);
  }
  assert.deepEqual((await aligner.evaluate({ ...input, mesh: webp }, truth)).warnings, []);
});

test("a texture as KTX2 is decoded by the caller's decoder", async () => {
  const ktx2 = [0xab, 0x4b, 0x54, 0x58, 0x20, 0x32, 0x30, 0xbb, 0x0d, 0x0a, 0x1a, 0x0a];
  const images = [{ uri: `data:image/ktx2;base64,${Buffer.from(ktx2).toString("base64")}` }];
  const texture = { extensions: { KHR_texture_basisu: { source: 0 } } };
  const file = glbOf(texturedJson(mesh, texture, { images, extensionsUsed: ["KHR_texture_basisu"] }), gltfBuffer(mesh));
  const seen: number[][] = [];
  const read = await readMesh(file, {
    decodeImage: (bytes) => {
      seen.push([...bytes]);
      return { data: Uint8Array.of(200, 30, 60), width: 1, height: 1 };
    },
  });
  assert.deepEqual([seen, read.warnings ?? []], [[ktx2], []]);
  assert.deepEqual([...(read.samples?.colors.subarray(0, 3) ?? [])], [200, 30, 60]);
  const undecoded = await readMesh(file);
  assert.match(undecoded.warnings?.[0] ?? "", /ktxdecompress/);
});

test("a mesh at the coordinates of a map has the pose of its file", async () => {
  const east = [500_123.25, 5_200_456.5, 312.125];
  const { positions, indices } = mesh as { positions: Float32Array; indices: Uint32Array };
  const far = Array.from(positions, (x, i) => x + (east[i % 3] ?? 0));
  const lines = Array.from({ length: far.length / 3 }, (_, i) => `v ${far.slice(3 * i, 3 * i + 3).join(" ")}`);
  const faces = Array.from(
    { length: indices.length / 3 },
    (_, i) => `f ${Array.from(indices.slice(3 * i, 3 * i + 3), (k) => k + 1).join(" ")}`,
  );
  const file = new TextEncoder().encode([...lines, ...faces].join("\n"));
  const quick = { quality: "fast", proportions: "full" } as const;
  const near = await aligner.align({ ...plain, mesh } as AlignInput, quick);
  const found = await aligner.align({ ...plain, mesh: file } as AlignInput, quick);
  assert.ok(found.proportions !== undefined && near.proportions !== undefined);
  const at = (matrix: readonly number[], point: readonly number[]) =>
    [0, 1, 2].map((row) => [0, 1, 2, 3].reduce((sum, k) => sum + (matrix[4 * k + row] ?? 0) * (point[k] ?? 1), 0));
  const points = [positions.subarray(0, 3), positions.subarray(300, 303)];
  /** That the mesh is placed as the near one is, whose coordinates are less by an origin. */
  const isPlaced = (matrix: readonly number[], origin: readonly number[], stretches: (Stretch | null)[] = []) => {
    const stretched = ({ stretch }: Stretch, point: readonly number[]) =>
      stretch.map((row) => row.reduce((sum, x, k) => sum + x * (point[k] ?? 0), 0));
    for (const point of points) {
      const moved = Array.from(point, (x, axis) => x + (origin[axis] ?? 0));
      const [of, own] = stretches;
      const expected = at((own ?? near).matrix, own ? stretched(own, [...point]) : [...point]);
      assertNear(at(matrix, of ? stretched(of, moved) : moved), expected, "placed", 2e-3);
    }
  };
  isPlaced(found.matrix, east);
  isPlaced(found.proportions.matrix, east, [found.proportions, near.proportions]);
  assert.ok(Math.abs(found.scale / near.scale - 1) < 5e-3);
  const { mask, ...seen } = plain;
  const start = { search: "local", initial: { matrix: found.matrix } } as const;
  for (const known of [{}, start]) {
    const scene = { ...seen, objects: [{ mask, mesh: file, ...known }] } as SceneInput;
    const [object] = (await aligner.alignScene(scene, { quality: "fast" })).objects;
    assert.ok(object !== undefined && object.error === undefined, object?.error?.message);
    isPlaced(object.matrix, east);
  }
  // Poses of what was read are of its arrays, from which the origin is subtracted.
  const read = await readMesh(file);
  const ofArrays = await aligner.align({ ...plain, mesh: read } as AlignInput, quick);
  isPlaced(
    ofArrays.matrix,
    east.map((x, axis) => x - (read.origin?.[axis] ?? 0)),
  );
  // The pose is that of the file in arguments, too.
  const { metrics } = await aligner.evaluate({ ...plain, mesh: file } as AlignInput, found);
  assert.ok((metrics.iou ?? 0) > 0.95, `${metrics.iou}`);
});

test("intrinsics that seem to be those of another image are named, in memory as in a file", async () => {
  const { fx, fy, cx, cy } = camera;
  const twice = { fx: 2 * fx, fy: 2 * fy, cx: 2 * cx + 0.5, cy: 2 * cy + 0.5 };
  // The photo has other proportions than the depth map.
  const stretched = { fx: 1.8 * fx, fy: 1.4 * fy, cx: 1.8 * cx + 0.4, cy: 1.4 * cy + 0.2 };
  const turned = { fx: fy, fy: fx, cx: cy, cy: cx };
  for (const name of ["camera", "cameraFile"]) {
    const of = (intrinsics: object) =>
      aligner.align({ ...plain, camera: undefined, [name]: intrinsics } as AlignInput, { quality: "fast" });
    for (const other of [twice, stretched, turned]) {
      assert.ok(codesOf((await of(other)).warnings).includes("CAMERA_DOUBTFUL"), name);
    }
    const known = await of({ fx, fy, cx, cy });
    assert.ok(!codesOf(known.warnings).includes("CAMERA_DOUBTFUL"), name);
    assert.deepEqual((await of({ ...twice, width: 2 * width, height: 2 * height })).matrix, known.matrix);
    const relative = { fx: fx / width, fy: fy / height, cx: (cx + 0.5) / width, cy: (cy + 0.5) / height };
    assert.ok(Math.abs((await of(relative)).scale / known.scale - 1) < 1e-3, "in sizes of the image");
  }
});

test("what a camera file holds besides is named in results, and in memory as well", async () => {
  const file = { ...camera, factor_depth: 1000, zoom: 2, D: [0.5, 0, 0, 0, 0] };
  const read = await readCamera(file, size);
  for (const input of [fileOf(file), { camera: read }]) {
    const { warnings } = await evaluated(input);
    assert.deepEqual(codesOf(warnings), ["CAMERA_NOT_PINHOLE", "CONTENT_NOT_READ"]);
  }
});

test("a mask with the labels of several objects is named where the pose is in doubt", async () => {
  const of = async (background: number) => {
    const side = (i: number) => (i % width < width / 2 ? 1 : 2);
    const labels = Uint8Array.from(mask, (pixel, i) => (pixel === 0 ? background * (side(i) - 1) : side(i)));
    return aligner.align({ ...plain, mask: npy(labels, height, width) } as AlignInput, { quality: "fast" });
  };
  const [parts, objects] = [await of(0), await of(3)];
  assert.ok(parts.confidence > 0.5 && parts.maskReading?.endsWith("labels"), `${parts.confidence}`);
  assert.ok(objects.confidence < 0.5, `${objects.confidence}`);
  const isNamed = [parts, objects].map(({ warnings }) => codesOf(warnings).includes("MASK_HAS_LABELS"));
  assert.deepEqual(isNamed, [false, true]);
});
