/** Camera files, pose files and case folders: what other tools write, and what is refused. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner } from "sim3align";
import { type CaseFiles, type ReadCameraOptions, readCamera, readCase, readPose } from "sim3align/formats";
import { type Fault, rejectsWith } from "../support/errors.js";
import { cocoRle, fixture, gltfBuffer, gltfJson, npy, obj, png } from "../support/files.js";
import { input, mesh, truth, view } from "../support/scene.js";

const K = [600, 0, 319.5, 0, 610, 239.5, 0, 0, 1];
const rows = [K.slice(0, 3), K.slice(3, 6), K.slice(6)];
const intrinsics = { fx: 600, fy: 610, cx: 319.5, cy: 239.5 };
const size = { width: 640, height: 480 };
const columns = [600, 0, 0, 0, 610, 0, 319.5, 239.5, 1];
const withNumber = (numbers: number[], place: number, number: number) =>
  numbers.map((other, i) => (i === place ? number : other));

const cameras: Record<string, unknown> = {
  "our own": intrinsics,
  "RealSense's": { fx: 600, fy: 610, ppx: 319.5, ppy: 239.5, ...size, model: "brown_conrady" },
  "K alone, in rows": rows,
  "K times 2": { K: K.map((number) => 2 * number) },
  "Open3D's, column by column": { ...size, intrinsic_matrix: [600, 0, 0, 0, 610, 0, 319.5, 239.5, 1] },
  "BOP's whole file": { "0": { cam_K: K, depth_scale: 0.1 } },
  "ROS 1": { header: { seq: 1 }, ...size, distortion_model: "plumb_bob", D: [0, 0, 0, 0, 0], K, R: [1] },
  "ROS 2": { ...size, d: [], k: K },
  "four numbers": [600, 610, 319.5, 239.5],
  "OneViewAll's and VGGT's": { intrinsic: [rows] },
  "a projection of 3 × 4": { intrinsics: rows.map((row) => [...row, 0]) },
  "a projection of 4 × 4, flat": { cam_K: [...rows.flatMap((row) => [...row, 0]), 0, 0, 0, 1] },
  "Record3D's, column by column": { ...{ w: 640, h: 480, dw: 192, dh: 256 }, K: columns },
  "ARKit's, column by column": { intrinsics: [columns.slice(0, 3), columns.slice(3, 6), columns.slice(6)] },
  "Polycam's": { ...intrinsics, ...size, t_00: 1 },
  "nerfstudio's": { fl_x: 600, fl_y: 610, cx: 319.5, cy: 239.5, w: 640, h: 480 },
  "RealSense's, nested": { intrinsics: { fx: 600, fy: 610, ppx: 319.5, ppy: 239.5, ...size } },
  "Open3D's, nested": { intrinsic: { ...size, intrinsic_matrix: columns }, extrinsic: [1] },
  "OpenCV's": { camera_matrix: { rows: 3, cols: 3, data: K }, image_width: 640, image_height: 480 },
  "MoGe's, in image sizes": {
    intrinsics: [
      [600 / 640, 0, 0.5],
      [0, 610 / 480, 0.5],
      [0, 0, 1],
    ],
  },
  "of an image twice as large": { fx: 1200, fy: 1220, cx: 639.5, cy: 479.5, width: 1280, height: 960 },
};

const texts: Record<string, string> = {
  "rows with spaces": "600 0 319.5\n0 610 239.5\n0 0 1\n",
  "rows with commas": "600.0, 0.0, 319.5\r\n0.0, 610.0, 239.5\r\n0.0, 0.0, 1.0",
  "as numpy.savetxt writes it": K.map((number) => number.toExponential(18)).join(" "),
  "as NumPy prints it": "[[600.    0.  319.5]\n [  0.  610.  239.5]\n [  0.    0.    1. ]]",
  "four numbers": "600;610;319.5;239.5",
  "4 × 4": "600 0 319.5 0\n0 610 239.5 0\n0 0 1 0\n0 0 0 1\n",
  names: "fx = 600\nfy: 610\ncx=319.5, cy=239.5",
  "COLMAP's": "# Camera list\n1 PINHOLE 640 480 600 610 320 240\n",
  "OpenCV's YAML":
    "%YAML:1.0\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 600., 0., 319.5, 0., 610., 239.5, 0., 0., 1. ]\n",
};

test("cameras as text are the same camera", async () => {
  for (const [name, text] of Object.entries(texts)) {
    for (const file of [text, Buffer.from(text)]) {
      const { fx, fy, cx, cy, warnings } = await readCamera(file, size);
      assert.deepEqual({ fx, fy, cx, cy, warnings }, { ...intrinsics, warnings: [] }, name);
    }
  }
});

test("cameras of every tool are the same camera, as bytes, text, Blob and object", async () => {
  for (const [name, json] of Object.entries(cameras)) {
    const text = JSON.stringify(json);
    const forms = [text, `\ufeff${text}`, Buffer.from(text), Buffer.from(`\ufeff${text}`), new Blob([text]), json];
    for (const file of forms) {
      const { fx, fy, cx, cy, warnings } = await readCamera(file as string, size);
      assert.deepEqual({ fx, fy, cx, cy, warnings }, { ...intrinsics, warnings: [] }, name);
    }
  }
});

test("a camera's size, depth scale, in millimetres for BOP, and field of view are those of the file", async () => {
  const full = { ...intrinsics, ...size, depthScale: 0.001 };
  assert.deepEqual(await readCamera(full), { ...full, warnings: [] });
  assert.equal((await readCamera({ ...intrinsics, depth_scale: 0.1 })).depthScale, 0.1 / 1000);
  const { fx, fy, cx } = await readCamera({ fov_y_deg: 60 }, size);
  assert.deepEqual([fx, cx], [fy, 319.5]);
});

test("of several images one has to be chosen", async () => {
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
    const fault = "INVALID_ARGUMENT options.imageId";
    await rejectsWith(() => readCamera(file, { imageId }), fault, /expected one of 3, 20, 100\./);
  }
  assert.equal((await readCamera({ "0": entry(5), "1": entry(6) }, { imageId: "000000" })).fx, 5);
});

const corrupt = ["", "nonsense", Buffer.of(0x7b, 0xff, 0x7d), "[".repeat(100_000)];
const others: unknown[] = [
  ...["1", "[]", "[1,2,3]", "{}", `{"fx":1e999}`, { fx: 600, fy: 610, cx: 319.5 }, { ...intrinsics, fx: "600" }],
  ...[{ K: [1, 2, 3] }, { K: [...rows, rows[0]] }, { K: "eye" }, { K: null }, { intrinsic_matrix: 7 }],
  ...[{ "0": { cam_R_m2c: [] } }, { ...intrinsics, fx: Number.NaN }],
];
const refusedCameras: [unknown, Fault, RegExp, ReadCameraOptions?][] = [
  ...corrupt.map((file): [unknown, Fault, RegExp] => [file, "CORRUPT_FILE camera", /JSON.* download or export/]),
  ...others.map((file): [unknown, Fault, RegExp] => [file, "INVALID_CAMERA camera", /fx, fy, cx and cy/]),
  [{ focal: 1, center: 2 }, "INVALID_CAMERA camera", /found an object with focal, center.* Write .* fx, fy, cx and cy/],
  [{ ...intrinsics, fx: 0 }, "INVALID_CAMERA camera.fx", /found 0/],
  ...[0, -1, "1", null].map((depth_scale): [unknown, Fault, RegExp] => [
    ...([{ ...intrinsics, depth_scale }, "INVALID_CAMERA camera.depthScale", /number above 0/] as const),
  ]),
  [{ K: withNumber(K, 8, 0) }, "INVALID_CAMERA camera.K", /row-major/],
  [`{${" ".repeat(1 << 24)}}`, "FILE_TOO_LARGE camera", /16777216/],
  [{ fovYDeg: 180 }, "INVALID_CAMERA camera.fovYDeg", /below 180/, size],
  [{ fovYDeg: 60 }, "INVALID_ARGUMENT options.width", /field of view/],
  [{ ...intrinsics, ...size }, "SIZE_MISMATCH camera", /640 × 480.*320 × 200/, { width: 320, height: 200 }],
];

test("what is no camera is refused", async () => {
  for (const [file, fault, message, options] of refusedCameras) {
    await rejectsWith(() => readCamera(file as string, options), fault, message);
  }
});

test("poses come as parts or as a matrix, as BOP's entry, or not at all", async () => {
  const matrix = [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 1, 2, 3, 1];
  const rotation = [
    [0, -1, 0],
    [1, 0, 0],
    [0, 0, 1],
  ];
  const rows = [0, 1, 2, 3].map((row) => [0, 4, 8, 12].map((column) => matrix[column + row]));
  const pose = { scale: 2, translation: [1, 2, 3], symmetry: "none" };
  const forms = [
    { ...pose, rotation, available: true },
    { ...pose, rotation: rotation.flat() },
    { ...pose, rotation: [0, 0, Math.SQRT1_2, Math.SQRT1_2] },
    ...[{ matrix }, matrix, rows.flat(), rows, rows.slice(0, 3), { pose: rows }, [{ ...pose, rotation }]],
  ];
  const texts = [
    rows.map((row) => row.join(" ")).join("\n"),
    `[${rows.map((row) => `[${row.join(". ")}.]`).join("\n ")}]`,
  ];
  for (const form of [...forms, ...texts]) {
    const json = typeof form === "string" ? form : JSON.stringify(form);
    for (const file of [form, json, Buffer.from(json)]) {
      const found = await readPose(file);
      for (const [i, number] of [...(found?.transform.matrix ?? [])].entries()) {
        assert.ok(Math.abs(number - (matrix[i] ?? 0)) < 1e-12, JSON.stringify(form));
      }
      assert.equal(found?.symmetry, "none");
    }
  }
  assert.equal(await readPose({ available: false, symmetry: "unknown" }), null);
  const bop = await readPose({ cam_R_m2c: rotation.flat(), cam_t_m2c: [1000, 2000, 3000] });
  assert.deepEqual([bop?.transform.scale, bop?.transform.translation], [0.001, [1, 2, 3]]);
  for (const [words, symmetry] of [
    [" Continuous about z", "auto"],
    ["discrete (4)", "auto"],
    ["unknown", "none"],
  ]) {
    assert.equal((await readPose({ matrix, symmetry: words }))?.symmetry, symmetry);
  }
});

test("what is no pose is refused", async () => {
  const rotation = [1, 0, 0, 0, 1, 0, 0, 0, 1];
  const pose = { scale: 1, rotation, translation: [0, 0, 0] };
  const invalid: [unknown, Fault][] = [
    [{ ...pose, scale: 0 }, "INVALID_TRANSFORM pose.scale"],
    [{ ...pose, rotation: withNumber(rotation, 8, -1) }, "INVALID_TRANSFORM pose.rotation"],
    [{ ...pose, translation: [0, 0] }, "INVALID_TRANSFORM pose.translation"],
    [{ matrix: [1, 2] }, "INVALID_TRANSFORM pose.matrix"],
    ["1 2 3", "CORRUPT_FILE pose"],
    ["{", "CORRUPT_FILE pose"],
  ];
  for (const [file, fault] of invalid) await rejectsWith(() => readPose(file as object), fault);
});

const { width, height, depth, mask, camera } = view;
const json = (value: unknown) => Buffer.from(JSON.stringify(value));
const files = {
  "depth.npy": npy(depth, height, width),
  "mask.json": json(cocoRle(mask, width, height)),
  "mesh.gltf": json(gltfJson(mesh, {}, { uri: "./sub/a%20b.bin" })),
  "sub/a b.bin": new Blob([Uint8Array.from(gltfBuffer(mesh))]),
  "camera.json": json(camera),
  "gt.json": json({ ...truth, symmetry: "discrete" }),
};

test("a case is read from files by their names, lazily where they are functions", async () => {
  const read: string[] = [];
  const lazy = (name: string, bytes: Uint8Array) => async () => {
    read.push(name);
    return bytes;
  };
  const { "mask.json": maskFile, ...withoutMask } = files;
  const all = { ...files, "mask.json": lazy("mask.json", maskFile), "notes.txt": lazy("notes.txt", new Uint8Array()) };
  const { input: found, files: names, unread, truth: pose } = await readCase(all);
  assert.deepEqual([read, unread], [["mask.json"], ["notes.txt"]]);
  const parts = { depth: "depth.npy", mask: "mask.json", mesh: "mesh.gltf", camera: "camera.json", truth: "gt.json" };
  assert.deepEqual(names, parts);
  assert.deepEqual([pose?.symmetry, pose?.transform.translation], ["auto", truth.translation]);
  const aligner = await createAligner();
  assert.deepEqual(await aligner.evaluate(found, truth), await aligner.evaluate(input, truth));
  const missing = /mask\.png or mask\.npy or mask\.json/;
  await rejectsWith(() => readCase(withoutMask), "FILE_NOT_FOUND mask", missing);
  for (const [part, name, both] of [
    ["depth", "depth.png", /depth\.npy and depth\.png.*--depth/],
    ["mask", "mask.png", /mask\.png and mask\.json.*--mask/],
    ["mesh", "mesh.glb", /mesh\.glb and mesh\.gltf.*--mesh/],
  ] as const)
    await rejectsWith(() => readCase({ ...files, [name]: maskFile }), `INVALID_ARGUMENT ${part}`, both);
  const { "sub/a b.bin": __, ...withoutBuffer } = files;
  await rejectsWith(() => readCase(withoutBuffer), "FILE_NOT_FOUND mesh", /sub\/a b\.bin/);
  for (const uri of ["../mesh.bin", "/mesh.bin", "file:///mesh.bin", "sub\\..\\..\\mesh.bin", "%2e%2e/mesh.bin"]) {
    const outside = { ...files, "mesh.gltf": json(gltfJson(mesh, {}, { uri })) };
    await rejectsWith(() => readCase(outside), "CORRUPT_FILE mesh", /below it/);
  }
});

test("a case's photo, textures and settings go into its input; a camera may be missing", async () => {
  const photo = fixture("photo.jpg");
  const found = await readCase({ ...files, "rgb.jpg": photo });
  assert.deepEqual([found.input.image, found.files.image], [photo, "rgb.jpg"]);
  const without = await readCase({ ...files, "rgb.jpg": photo }, { image: false });
  assert.deepEqual(["image" in without.input, "image" in without.files], [false, false]);
  const { "mesh.gltf": _, ...others } = files;
  const named = Buffer.concat([Buffer.from("mtllib my.mtl\n"), obj(mesh)]);
  const library = Buffer.from("newmtl print\nmap_Kd maps/print.png\n");
  const textured = { ...others, "mesh.obj": named, "my.mtl": library, "maps/print.png": fixture("photo.png") };
  const { resources } = (await readCase(textured)).input.mesh as { resources: object };
  assert.deepEqual(Object.keys(resources).sort(), ["maps/print.png", "my.mtl"]);
  const { "camera.json": __, ...uncalibrated } = files;
  const entry = { cam_K: [camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1] };
  const scene = { ...uncalibrated, "scene_camera.json": json({ "7": entry, "8": entry }) };
  const chosen = await readCase(scene, { imageId: 7, depthScale: 0.0001 });
  assert.deepEqual([chosen.input.imageId, chosen.input.depthScale], [7, 0.0001]);
  const alone = await readCase(uncalibrated, { depthKind: "affine-invariant" });
  assert.equal(alone.input.depthKind, "affine-invariant");
  assert.ok(!("cameraFile" in alone.input) && !("camera" in alone.files));
  assert.equal(
    (await readCase({ ...files, "depth.npy": png(Uint16Array.from(depth), width, height) })).files.depth,
    "depth.npy",
  );
});

test("the usual names of each part are found, in any case; what is not read is named", async () => {
  const { "camera.json": _, ...rest } = files;
  const { "mask.json": maskFile, ...withoutMask } = rest;
  const text = Buffer.from("600 0 319.5\n0 610 239.5\n0 0 1\n");
  const photo = fixture("photo.jpg");
  const others = { "notes.txt": text, "view_10.png": photo, "view_9.png": photo, "sub/more.txt": text };
  const known = { ".DS_Store": text, "Thumbs.db": text, "results.json": text, "results.jsonl.lock": text };
  const rows: [string, CaseFiles, Record<string, string>, string[]?][] = [
    ...["cam_K.txt", "K.txt", "Intrinsics.TXT", "intrinsic.txt", "intrinsics.json", "cameras.txt", "camera.yaml"].map(
      (camera): (typeof rows)[number] => [camera, { ...rest, [camera]: text }, { camera }],
    ),
    ...["rgb.webp", "IMAGE.JPEG", "photo.jpg", "color.png", "Colour.JPG"].map((image): (typeof rows)[number] => [
      image,
      { ...rest, [image]: photo },
      { image },
    ]),
    ["a mask in capitals", { ...withoutMask, "MASK.Json": maskFile }, { mask: "MASK.Json" }],
    [
      "the depth camera's intrinsics before the colour camera's",
      { ...rest, "intrinsic_color.txt": text, "intrinsic_depth.txt": text },
      { camera: "intrinsic_depth.txt" },
      ["intrinsic_color.txt"],
    ],
    ["other files", { ...rest, ...others, ...known }, {}, ["notes.txt", "sub/more.txt", "view_9.png", "view_10.png"]],
    ["what only scenes have", { ...rest, "initial.json": text }, {}, ["initial.json"]],
  ];
  for (const [what, all, parts, unread = []] of rows) {
    const found = await readCase(all);
    for (const [part, name] of Object.entries(parts))
      assert.equal((found.files as Record<string, string>)[part], name, what);
    assert.deepEqual(found.unread, unread, what);
  }
  assert.deepEqual((await readCase({ ...rest, "K.txt": text })).input.cameraFile, text);
  assert.deepEqual((await readCase({ ...rest, "photo.jpg": photo }, { image: false })).unread, [], "not wanted");
  for (const [name, part] of [
    ["K.txt", "camera"],
    ["GT.json", "truth"],
  ] as const)
    await rejectsWith(() => readCase({ ...files, [name]: text }), `INVALID_ARGUMENT ${part}`, /one of them/);
  const unknown = { ...withoutMask, "mask.bmp": photo };
  await rejectsWith(() => readCase(unknown), "FILE_NOT_FOUND mask", /no such file in the files, beside mask\.bmp/);
});
