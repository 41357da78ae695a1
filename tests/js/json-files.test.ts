/** Pose files and case folders: what other tools write, and what is refused. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner } from "sim3align";
import { type CaseFiles, readCase, readFrames, readPose } from "sim3align/formats";
import { type Fault, rejectsWith } from "../support/errors.js";
import { cocoRle, fixture, gltfBuffer, gltfJson, npy, obj, png } from "../support/files.js";
import { input, mesh, truth, view } from "../support/scene.js";

const withNumber = (numbers: number[], place: number, number: number) =>
  numbers.map((other, i) => (i === place ? number : other));

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

test("frames are read in the order of their numbers, from folders and from the layout of FoundationPose", async () => {
  const { "depth.npy": depthFile, "mask.json": maskFile, "gt.json": _, "camera.json": cameraFile, ...shape } = files;
  const numbers = [10, 2, 1];
  const folders = numbers.map((k) => [`frame_${k}/Depth.NPY`, depthFile]);
  const columns = numbers.map((k) => [`depth/${k}.npy`, depthFile]);
  const shapeBelow = Object.entries(shape).map(([name, file]) => [`mesh/${name.replace("mesh.", "mug.")}`, file]);
  for (const [all, names, views, masked] of [
    [{ ...shape, "frame_1/mask.json": maskFile, ...Object.fromEntries(folders) }, [1, 2, 10], [1, 2, 10], "frame_"],
    [{ ...Object.fromEntries([...shapeBelow, ...columns]), "masks/1.json": maskFile }, [1, 2, 10], [1], ""],
  ] as const) {
    const found = await readFrames({ ...all, "K.json": cameraFile, "notes.txt": cameraFile } as CaseFiles);
    assert.deepEqual(
      found.names,
      names.map((k) => `${masked}${k}`),
    );
    assert.deepEqual(
      found.views,
      views.map((k) => `${masked}${k}`),
    );
    assert.deepEqual(Object.keys((found.mesh as { resources: object }).resources), ["./sub/a%20b.bin"]);
    const [first, last] = [await found.read(`${masked}1`), await found.read(`${masked}10`)];
    assert.deepEqual(first.input, { depth: depthFile, mask: maskFile, cameraFile });
    assert.deepEqual(last.input, { depth: depthFile, cameraFile });
    assert.deepEqual(found.found().unread, ["notes.txt"]);
  }
  await rejectsWith(() => readFrames({ "frame_1/depth.npy": depthFile }), "FILE_NOT_FOUND mesh", /mesh\.glb/);
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
    ...[
      ...["cam_K.txt", "K.npy", "Intrinsics.TXT", "intrinsic.txt", "intrinsics.json", "cameras.txt", "camera.yaml"],
      ...["transforms.json", "camera_matrix.csv", "camera_params.json", "cam.json", "calib.txt", "41048190_9.6.pincam"],
    ].map((camera): (typeof rows)[number] => [camera, { ...rest, [camera]: text }, { camera }]),
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
    [
      "the usual name before one of other programs",
      { ...rest, "K.txt": text, "transforms.json": text, "calib.txt": text },
      { camera: "K.txt" },
      ["calib.txt", "transforms.json"],
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
  await rejectsWith(() => readCase(unknown), "FILE_NOT_FOUND mask", /no mask file in the files, beside mask\.bmp/);
});
