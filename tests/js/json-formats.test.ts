/** Camera files, pose files, masks in JSON and case folders: what other tools write, and what is refused. */
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { createAligner } from "sim3align";
import { type ReadCameraOptions, readCamera, readCase, readMask, readPose } from "sim3align/formats";
import { repository } from "../support/environment.js";
import { type Fault, rejectsWith } from "../support/errors.js";
import { cocoRle, gltfBuffer, gltfJson, npy, png } from "../support/files.js";
import { input, mesh, truth, view } from "../support/scene.js";

const fixture = (name: string) => readFileSync(join(repository, "tests", "fixtures", name));
const K = [600, 0, 319.5, 0, 610, 239.5, 0, 0, 1];
const [first, second, third] = [K.slice(0, 3), K.slice(3, 6), K.slice(6)];
const intrinsics = { fx: 600, fy: 610, cx: 319.5, cy: 239.5 };
const size = { width: 640, height: 480 };
const withNumber = (numbers: number[], place: number, number: number) =>
  numbers.map((other, i) => (i === place ? number : other));

const cameras: Record<string, unknown> = {
  "our own": intrinsics,
  "RealSense's": { fx: 600, fy: 610, ppx: 319.5, ppy: 239.5, ...size, model: "brown_conrady" },
  "K in one row": { K },
  "K in rows": { K: [first, second, third] },
  "K alone": K,
  "K alone, in rows": [first, second, third],
  "K times 2": { K: K.map((number) => 2 * number) },
  "Open3D's, column by column": { ...size, intrinsic_matrix: [600, 0, 0, 0, 610, 0, 319.5, 239.5, 1] },
  "BOP's whole file": { "0": { cam_K: K, depth_scale: 0.1 } },
  "BOP's entry": { cam_K: K, depth_scale: 0.1 },
  "ROS 1": { header: { seq: 1 }, ...size, distortion_model: "plumb_bob", D: [0, 0, 0, 0, 0], K, R: [1] },
  "ROS 2": { ...size, d: [], k: K },
};

for (const [name, json] of Object.entries(cameras)) {
  test(`camera: ${name} is the same camera, as bytes, text, Blob and object`, async () => {
    const text = JSON.stringify(json);
    const forms = [text, `\ufeff${text}`, Buffer.from(text), Buffer.from(`\ufeff${text}`), new Blob([text]), json];
    for (const file of forms) {
      const { fx, fy, cx, cy, warnings } = await readCamera(file as string, size);
      assert.deepEqual({ fx, fy, cx, cy, warnings }, { ...intrinsics, warnings: [] });
    }
  });
}

test("camera: size and depth scale are those of the file", async () => {
  const full = { ...intrinsics, ...size, depthScale: 0.001 };
  assert.deepEqual(await readCamera(full), { ...full, warnings: [] });
  assert.deepEqual(await readCamera({ ...intrinsics, width: 1.5, height: -1 }), { ...intrinsics, warnings: [] });
  // BOP's depth_scale is in millimetres: YCB-Video's 0.1 is a tenth of one.
  assert.equal((await readCamera({ ...intrinsics, depth_scale: 0.1 })).depthScale, 0.1 / 1000);
  for (const depth_scale of [0, -1, "1", null]) {
    const refused = () => readCamera({ ...intrinsics, depth_scale });
    await rejectsWith(refused, "INVALID_CAMERA camera.depthScale", /number above 0/);
  }
});

test("camera: a field of view needs the size of the image", async () => {
  for (const file of [{ fovYDeg: 60 }, { fov_y_deg: 60 }, { fovYDeg: 60, ...size }]) {
    const { fx, fy, cx, cy } = await readCamera(file, size);
    // tan 30° = 1/√3.
    assert.ok(Math.abs(fx - 240 * Math.sqrt(3)) < 1e-10 && fx === fy, `${fx}`);
    assert.deepEqual([cx, cy], [319.5, 239.5]);
  }
  assert.equal((await readCamera({ fovYDeg: 60, ...size })).cy, 239.5);
  const unknown = ["INVALID_ARGUMENT options.width", /field of view/] as const;
  await rejectsWith(() => readCamera({ fovYDeg: 60 }), ...unknown);
  const flat = ["INVALID_CAMERA camera.fovYDeg", /below 180/] as const;
  await rejectsWith(() => readCamera({ fovYDeg: 180 }, size), ...flat);
});

test("camera: the focal length of a field of view is exact to the last bits, for every angle", async () => {
  for (let degrees = 0.5; degrees < 180; degrees += 0.5) {
    const { fy } = await readCamera({ fovYDeg: degrees }, size);
    const expected = 240 / Math.tan((degrees * Math.PI) / 360);
    assert.ok(Math.abs(fy - expected) <= 8 * Number.EPSILON * 240 * Math.max(1, expected / 240), `${degrees}: ${fy}`);
  }
});

test("camera: of several images one has to be chosen", async () => {
  const entry = (f: number) => ({ cam_K: [f, 0, 1, 0, f, 1, 0, 0, 1], depth_scale: 1 });
  const file = { "3": entry(3), "20": entry(20), "100": entry(100) };
  for (const [imageId, fx] of [
    ["3", 3],
    [20, 20],
    ["000100", 100],
  ] as const) {
    assert.equal((await readCamera(file, { imageId })).fx, fx);
  }
  for (const imageId of [undefined, "4", ""]) {
    const message = /expected one of 3, 20, 100\./;
    const refused = () => readCamera(file, { imageId });
    await rejectsWith(refused, "INVALID_ARGUMENT options.imageId", message);
  }
  const many = Object.fromEntries(Array.from({ length: 30 }, (_, i) => [i, entry(i + 1)]));
  const listed = ["INVALID_ARGUMENT options.imageId", /18, 19, … \(30 in all\)/] as const;
  await rejectsWith(() => readCamera(many), ...listed);
  assert.equal((await readCamera({ "0": entry(5), "1": entry(6) }, { imageId: "000000" })).fx, 5);
});

test("camera: lens distortion is warned of, and another image's size is refused", async () => {
  const ros = { ...size, D: [0.1, -0.2, 0, 0, 0], K };
  const { warnings } = await readCamera(ros);
  assert.equal(warnings.length, 1);
  assert.match(warnings[0] ?? "", /rectified/);
  await rejectsWith(() => readCamera(ros, { width: 320, height: 240 }), "SIZE_MISMATCH camera", /640 × 480.*320 × 240/);
});

/** Files that may be damaged: text that is no JSON. */
const corrupt: unknown[] = [
  ...["", "nonsense", Buffer.of(0x7b, 0xff, 0x7d), `{"fx":1e999}`],
  ...["[".repeat(100_000), `${"[".repeat(100_000)}${"]".repeat(100_000)}`],
];

/** Other files. */
const others: unknown[] = [
  ...["1", "[]", "[1,2,3]", "{}"],
  ...[
    { fx: 600, fy: 610, cx: 319.5 },
    { ...intrinsics, fx: "600" },
    { ...intrinsics, fx: Number.NaN },
  ],
  ...[{ K: [1, 2, 3] }, { K: [first, second, third, third] }, { K: "eye" }, { K: null }, { intrinsic_matrix: 7 }],
  { "0": { cam_R_m2c: [] } },
];

const refusedCameras: [unknown, Fault, RegExp, ReadCameraOptions?][] = [
  ...corrupt.map((file): [unknown, Fault, RegExp] => [file, "CORRUPT_FILE camera", /JSON.* download or export/]),
  ...others.map((file): [unknown, Fault, RegExp] => [file, "INVALID_CAMERA camera", /fx, fy, cx and cy/]),
  [{ focal: 1, center: 2 }, "INVALID_CAMERA camera", /found an object with focal, center.* Write .* fx, fy, cx and cy/],
  [{ ...intrinsics, fx: 0 }, "INVALID_CAMERA camera.fx", /found 0/],
  // A column-major K, as of MATLAB.
  [[600, 0, 0, 0, 610, 0, 319.5, 239.5, 1], "INVALID_CAMERA camera.K", /transpose/],
  [{ K: withNumber(K, 8, 0) }, "INVALID_CAMERA camera.K", /row-major/],
  [{ K: withNumber(K, 1, 1) }, "INVALID_CAMERA camera.K", /row-major/],
  [`{${" ".repeat(1 << 24)}}`, "FILE_TOO_LARGE camera", /16777216/],
  [7, "INVALID_ARGUMENT file", /number 7/],
  [intrinsics, "INVALID_ARGUMENT options.width", /1\.5/, { width: 1.5 }],
];

test("camera: other content is refused", async () => {
  for (const [file, fault, message, options] of refusedCameras) {
    await rejectsWith(() => readCamera(file as string, options), fault, message);
  }
});

test("poses come as parts or as a matrix, as BOP's entry, or not at all", async () => {
  const matrix = [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 1, 2, 3, 1];
  const rows = [
    [0, -1, 0],
    [1, 0, 0],
    [0, 0, 1],
  ];
  const pose = { scale: 2, translation: [1, 2, 3], symmetry: "none" };
  const forms = [
    { ...pose, rotation: rows, available: true },
    { ...pose, rotation: rows.flat() },
    { ...pose, rotation: [0, 0, Math.SQRT1_2, Math.SQRT1_2] },
    { matrix },
    matrix,
  ];
  for (const form of forms) {
    for (const file of [form, JSON.stringify(form), Buffer.from(JSON.stringify(form))]) {
      const found = await readPose(file);
      for (const [i, number] of [...(found?.transform.matrix ?? [])].entries()) {
        assert.ok(Math.abs(number - (matrix[i] ?? 0)) < 1e-12, JSON.stringify(form));
      }
      assert.deepEqual(found?.symmetry, "none");
    }
  }
  assert.equal(await readPose({ available: false, symmetry: "unknown" }), null);
  const bop = await readPose({ cam_R_m2c: rows.flat(), cam_t_m2c: [1000, 2000, 3000] });
  assert.deepEqual([bop?.transform.scale, bop?.transform.translation], [0.001, [1, 2, 3]]);
  const symmetries = { " Continuous about z": "auto", "discrete (4)": "auto", unknown: "none" };
  for (const [words, symmetry] of Object.entries(symmetries)) {
    assert.equal((await readPose({ matrix, symmetry: words }))?.symmetry, symmetry);
  }
});

test("poses: other content is refused", async () => {
  const rotation = [1, 0, 0, 0, 1, 0, 0, 0, 1];
  const pose = { scale: 1, rotation, translation: [0, 0, 0] };
  const invalid: [unknown, string][] = [
    [{ ...pose, scale: 0 }, "pose.scale"],
    [{ ...pose, rotation: withNumber(rotation, 8, -1) }, "pose.rotation"],
    [{ ...pose, rotation: [0, 0, 0, 0] }, "pose.rotation"],
    [{ ...pose, rotation: 7 }, "pose.rotation"],
    [{ ...pose, translation: [0, 0] }, "pose.translation"],
    [{}, "pose.scale"],
    [{ matrix: [1, 2] }, "pose.matrix"],
    // A row-major matrix.
    [{ matrix: [1, 0, 0, 5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] }, "pose"],
  ];
  for (const [file, argument] of invalid) {
    await rejectsWith(() => readPose(file as object), `INVALID_TRANSFORM ${argument}`);
  }
  await rejectsWith(() => readPose("7"), "INVALID_TRANSFORM pose", /not an object/);
  for (const file of ["{", `{"scale":1,"rotation":[1],"translation":[0,0,1e999]}`]) {
    await rejectsWith(() => readPose(file), "CORRUPT_FILE pose");
  }
});

test("masks: COCO RLE of pycocotools, compressed and plain, as file and object", async () => {
  const small = await readMask(fixture("mask-grey.png"));
  for (const name of ["rle-small.json", "rle-small-plain.json"]) {
    const json = JSON.parse(fixture(name).toString());
    const annotation = Buffer.from(`\ufeff ${JSON.stringify({ id: 1, segmentation: json })}`);
    for (const file of [fixture(name), json, annotation]) assert.deepEqual(await readMask(file), small, name);
  }
  // The blob's pixels and bounding box (x 61 to 319, y 0 to 239) as pycocotools counts them.
  for (const name of ["rle-blob.json", "rle-blob-plain.json"]) {
    const { data, width, height } = await readMask(fixture(name));
    assert.deepEqual([width, height], [320, 240]);
    assert.equal(data.filter((pixel) => pixel === 1).length, 24117);
    const columns = Array.from(data.keys())
      .filter((i) => data[i] === 1)
      .map((i) => i % 320);
    assert.deepEqual([columns.reduce((a, b) => Math.min(a, b)), columns.reduce((a, b) => Math.max(a, b))], [61, 319]);
  }
});

test("masks: run lengths that do not fit are refused", async () => {
  const refused: [string, string, Fault][] = [
    ["[5,7]", "[36]", "CORRUPT_FILE mask.counts"],
    ["[5,7]", "[30,4]", "CORRUPT_FILE mask.counts"],
    ["[5,7]", "[4294967295,4294967295]", "CORRUPT_FILE mask.counts"],
    ["[5,7]", "[-1,36]", "CORRUPT_FILE mask.counts"],
    ["[5,7]", "[1.5]", "CORRUPT_FILE mask.counts"],
    ["[5,7]", '"~"', "CORRUPT_FILE mask.counts"],
    ["[5,7]", "{}", "INVALID_ARGUMENT mask.counts"],
    ["[0,7]", "[0]", "EMPTY_IMAGE mask.size"],
    ["[100000,100000]", "[1]", "FILE_TOO_LARGE mask.size"],
    ["[5,7,1]", "[35]", "UNSUPPORTED_FORMAT mask"],
    ["[5]", "[35]", "UNSUPPORTED_FORMAT mask"],
    ["7", "[35]", "UNSUPPORTED_FORMAT mask"],
  ];
  for (const [rle, counts, fault] of refused) {
    const file = Buffer.from(`{"size":${rle},"counts":${counts}}`);
    await rejectsWith(() => readMask(file), fault);
  }
  await rejectsWith(() => readMask(Buffer.from("{}")), "UNSUPPORTED_FORMAT mask", /run-length/);
});

test("a case is read from files by their names, lazily where they are functions", async () => {
  const { depth, mask, camera, width, height } = view;
  const read: string[] = [];
  const lazy = (name: string, bytes: Uint8Array) => async () => {
    read.push(name);
    return bytes;
  };
  const files = {
    "depth.npy": npy(depth, height, width),
    "depth.png": lazy("depth.png", Uint8Array.of()),
    "mask.json": lazy("mask.json", Buffer.from(JSON.stringify(cocoRle(mask, width, height)))),
    "mesh.gltf": Buffer.from(JSON.stringify(gltfJson(mesh, {}, { uri: "./sub/a%20b.bin" }))),
    "sub/a b.bin": new Blob([gltfBuffer(mesh) as Uint8Array<ArrayBuffer>]),
    "camera.json": Buffer.from(JSON.stringify(camera)),
    "gt.json": Buffer.from(JSON.stringify({ ...truth, symmetry: "discrete" })),
    "photo.jpg": lazy("photo.jpg", Uint8Array.of()),
  };
  const { input: found, files: names, truth: pose } = await readCase(files);
  assert.deepEqual(read, ["mask.json"]);
  assert.deepEqual(names, { depth: "depth.npy", mask: "mask.json", mesh: "mesh.gltf", camera: "camera.json" });
  assert.equal(pose?.symmetry, "auto");
  assert.deepEqual(pose?.transform.translation, truth.translation);
  const aligner = await createAligner();
  assert.deepEqual(await aligner.evaluate(found, truth), await aligner.evaluate(input, truth));

  const { "mask.json": _, ...noMask } = files;
  const missing = ["FILE_NOT_FOUND mask", /mask\.png or mask\.npy or mask\.json/] as const;
  await rejectsWith(() => readCase(noMask), ...missing);
  const { "sub/a b.bin": __, ...noBuffer } = files;
  await rejectsWith(() => readCase(noBuffer), "FILE_NOT_FOUND mesh", /sub\/a b\.bin/);
  for (const uri of ["../mesh.bin", "/mesh.bin", "file:///mesh.bin", "sub\\..\\..\\mesh.bin", "%2e%2e/mesh.bin"]) {
    const outside = { ...files, "mesh.gltf": Buffer.from(JSON.stringify(gltfJson(mesh, {}, { uri }))) };
    const expected = ["CORRUPT_FILE mesh", /below it/] as const;
    await rejectsWith(() => readCase(outside), ...expected);
  }
});

test("a case's settings go into its input", async () => {
  const { mask, camera, width, height, depth } = view;
  const K = [camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1];
  const tenths = Uint16Array.from(depth, (z) => Math.round(10_000 * z));
  const files = {
    "depth.png": png(tenths, width, height),
    "mask.png": png(mask, width, height),
    "mesh.obj": Buffer.from("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    "scene_camera.json": Buffer.from(JSON.stringify({ "7": { cam_K: K }, "8": { cam_K: K } })),
  };
  const { input: found, truth: pose } = await readCase(files, { imageId: 7, depthScale: 0.0001 });
  assert.equal(pose, null);
  assert.deepEqual([found.imageId, found.depthScale], [7, 0.0001]);

  const { "scene_camera.json": _, ...noCamera } = files;
  const { input: alone, files: names } = await readCase(noCamera, { depthKind: "affine-invariant" });
  assert.equal(alone.depthKind, "affine-invariant");
  assert.ok(!("cameraFile" in alone) && !("camera" in names), "the camera may be missing");
});
