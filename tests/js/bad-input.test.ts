/** What bad input gets: a typed error that says what to do, and an aligner that works on. */
import assert from "node:assert/strict";
import { after, test } from "node:test";
import { type AlignInput, type AlignOptions, createAligner, type ErrorCode } from "sim3align";
import { rejectsWith } from "../support/errors.js";
import { glb, glbOf, gltfBuffer, gltfJson, npy, png } from "../support/files.js";
import { input, mesh, truth, view } from "../support/scene.js";

const { width, height, depth, mask, camera } = view;
const aligner = await createAligner();
const reference = (await aligner.evaluate(input, truth)).metrics;

/** A case: what is changed in a good input, and the error that it gets. */
type Bad = [name: string, change: object, code: ErrorCode, argument: string, message: RegExp];

const pixels = width * height;
const filled = (value: number) => depth.map((z, i) => (mask[i] === 0 ? z : value));
const changed = <T extends { slice(): T; [index: number]: number }>(array: T, index: number, value: number): T => {
  const copy = array.slice();
  copy[index] = value;
  return copy;
};
const tiny = mask.map((m, i) => (m !== 0 && i < mask.indexOf(1) + 5 ? 1 : 0));
const scaled = (x: number, y: number, z: number) => ({
  ...mesh,
  positions: mesh.positions.map((value, i) => value * ([x, y, z][i % 3] ?? 0)),
});
const withoutDepth = { ...input, depth: undefined };
const withoutMesh = { ...input, mesh: undefined };

const arrays: Bad[] = [
  ["depth missing", { depth: undefined }, "INVALID_ARGUMENT", "depth", /found nothing, expected a Float32Array/],
  [
    "depth as a plain array",
    { depth: Array.from(depth) },
    "INVALID_ARGUMENT",
    "depth",
    /plain array of 19200.*Float32Array\.from\(depth\)/,
  ],
  [
    "depth as doubles",
    { depth: Float64Array.from(depth) },
    "INVALID_ARGUMENT",
    "depth",
    /Float64Array.*Float32Array\.from\(depth\)/,
  ],
  [
    "depth in an object, as a plain array",
    { depth: { data: [1], width: 1, height: 1 } },
    "INVALID_ARGUMENT",
    "depth.data",
    /Float32Array\.from/,
  ],
  ["8-bit depth", { depth: new Uint8Array(pixels).fill(9) }, "EIGHT_BIT_DEPTH", "depth", /256 levels/],
  ["depth too short", { depth: depth.slice(1) }, "WRONG_LENGTH", "depth", /19199 values.*160 × 120 = 19200/],
  ["depth of no size", { depth: new Float32Array(0), width: 0, height: 0 }, "EMPTY_IMAGE", "depth", /0 × 0 pixels/],
  ["width missing", { width: undefined }, "INVALID_ARGUMENT", "width", /nothing/],
  ["width as a fraction", { width: 160.5 }, "INVALID_ARGUMENT", "width", /160\.5/],
  ["width as text", { width: "160" }, "INVALID_ARGUMENT", "width", /string/],
  ["width as NaN", { width: Number.NaN }, "INVALID_ARGUMENT", "width", /NaN/],
  [
    "sizes that contradict",
    { depth: { data: depth, width, height }, width: 99 },
    "SIZE_MISMATCH",
    "depth",
    /160 × 120 pixels.*99 × 120/,
  ],
  ["an absurd size", { width: 4e9, height: 4e9 }, "INVALID_ARGUMENT", "width", /4000000000/],
  ["a depth scale of zero", { depthScale: 0 }, "INVALID_ARGUMENT", "depthScale", /found 0/],
  ["a depth scale as text", { depthScale: "mm" }, "INVALID_ARGUMENT", "depthScale", /string/],
  ["a misspelt property", { depth_scale: 0.001 }, "INVALID_ARGUMENT", "input.depth_scale", /depthScale/],
  ["mask missing", { mask: undefined }, "INVALID_ARGUMENT", "mask", /found nothing, expected a Uint8Array/],
  ["mask as a plain array", { mask: Array.from(mask) }, "INVALID_ARGUMENT", "mask", /Uint8Array\.from\(mask\)/],
  ["mask as floats", { mask: Float32Array.from(mask) }, "INVALID_ARGUMENT", "mask", /Uint8Array\.from\(mask\)/],
  ["mask too short", { mask: mask.slice(1) }, "WRONG_LENGTH", "mask", /19199 values.*160 × 120/],
  [
    "mask of another size",
    { mask: { data: new Uint8Array(80 * 60), width: 80, height: 60 } },
    "SIZE_MISMATCH",
    "mask",
    /80 × 60 pixels.*160 × 120.*resizeMask/s,
  ],
  ["an unknown way of resizing", { resizeMask: "bilinear" }, "INVALID_ARGUMENT", "resizeMask", /"nearest"/],
  ["mask empty", { mask: new Uint8Array(pixels) }, "EMPTY_MASK", "mask", /no non-zero pixel/],
  ["mask without depth", { depth: filled(0) }, "NO_DEPTH_IN_MASK", "depth", /no reading in the \d+ pixels/],
  ["mask with NaN depth", { depth: filled(Number.NaN) }, "NO_DEPTH_IN_MASK", "depth", /no reading/],
  ["depth all equal", { depth: filled(0.7) }, "FLAT_DEPTH", "depth", /0\.7 m in all \d+ readings/],
  ["too few points", { mask: tiny }, "TOO_FEW_POINTS", "depth", /at least \d+/],
  ["camera missing", { camera: undefined }, "INVALID_ARGUMENT", "camera", /found nothing/],
  ["camera as a number", { camera: 600 }, "INVALID_ARGUMENT", "camera", /number 600/],
  ["camera with NaN", { camera: { ...camera, cx: Number.NaN } }, "INVALID_CAMERA", "camera.cx", /NaN/],
  ["camera with fx of zero", { camera: { ...camera, fx: 0 } }, "INVALID_CAMERA", "camera.fx", /found 0/],
  ["camera with negative fy", { camera: { ...camera, fy: -600 } }, "INVALID_CAMERA", "camera.fy", /-600/],
  [
    "camera with fx missing",
    { camera: { fy: 1, cx: 1, cy: 1, fx: undefined } },
    "INVALID_ARGUMENT",
    "camera.fx",
    /nothing|undefined/,
  ],
  [
    "K column by column",
    { camera: { K: [300, 0, 0, 0, 300, 0, 80, 60, 1] } },
    "INVALID_CAMERA",
    "camera.K",
    /transpose/,
  ],
  [
    "K of eight numbers",
    { camera: { K: [1, 2, 3, 4, 5, 6, 7, 8] } },
    "WRONG_LENGTH",
    "camera.K",
    /9 numbers|3 × 3|3×3/,
  ],
  ["a field of view of 180°", { camera: { fovYDeg: 180 } }, "INVALID_CAMERA", "camera.fovYDeg", /below 180/],
  [
    "a camera of another image",
    { camera: { ...camera, width: 640, height: 480 } },
    "SIZE_MISMATCH",
    "camera",
    /640 × 480.*160 × 120/,
  ],
  ["a camera file as camera", { camera: { cam_K: [] } }, "INVALID_ARGUMENT", "camera", /cameraFile/],
  ["camera text", { camera: "{}" }, "INVALID_ARGUMENT", "camera", /cameraFile/],
  ["camera and camera file", { cameraFile: "{}" }, "INVALID_ARGUMENT", "cameraFile", /not both/],
  [
    "camera file text that is no JSON",
    { camera: undefined, cameraFile: "fx=600" },
    "CORRUPT_FILE",
    "cameraFile",
    /JSON/,
  ],
  [
    "a camera file with a focal length of 0",
    { camera: undefined, cameraFile: { ...camera, fx: 0 } },
    "INVALID_CAMERA",
    "cameraFile.fx",
    /found 0/,
  ],
  [
    "a scene camera without image id",
    { camera: undefined, cameraFile: { "1": { cam_K: [] }, "2": { cam_K: [] } } },
    "INVALID_ARGUMENT",
    "imageId",
    /one of 1, 2/,
  ],
  ["mesh missing", { mesh: undefined }, "INVALID_ARGUMENT", "mesh", /found nothing/],
  [
    "positions as a plain array",
    { mesh: { positions: [0, 0, 0] } },
    "INVALID_ARGUMENT",
    "mesh.positions",
    /Float32Array\.from/,
  ],
  [
    "positions as doubles",
    { mesh: { positions: new Float64Array(9) } },
    "INVALID_ARGUMENT",
    "mesh.positions",
    /Float32Array\.from/,
  ],
  [
    "positions not in threes",
    { mesh: { ...mesh, positions: mesh.positions.slice(1) } },
    "WRONG_LENGTH",
    "mesh.positions",
    /multiple of 3/,
  ],
  [
    "indices as a plain array",
    { mesh: { ...mesh, indices: [0, 1, 2] } },
    "INVALID_ARGUMENT",
    "mesh.indices",
    /Uint32Array\.from/,
  ],
  [
    "indices not in threes",
    { mesh: { ...mesh, indices: mesh.indices.slice(1) } },
    "WRONG_LENGTH",
    "mesh.indices",
    /multiple of 3/,
  ],
  [
    "an index out of range",
    { mesh: { ...mesh, indices: changed(mesh.indices, 7, 1e6) } },
    "INDEX_OUT_OF_RANGE",
    "mesh.indices",
    /1000000 in triangle 2/,
  ],
  ["no triangle", { mesh: { ...mesh, indices: new Uint32Array(0) } }, "EMPTY_MESH", "mesh", /no triangle/],
  ["no vertex", { mesh: { positions: new Float32Array(0) } }, "EMPTY_MESH", "mesh", /no triangle/],
  [
    "a NaN vertex",
    { mesh: { ...mesh, positions: changed(mesh.positions, 4, Number.NaN) } },
    "NON_FINITE",
    "mesh.positions",
    /NaN.*vertex 1/,
  ],
  [
    "an infinite vertex",
    { mesh: { ...mesh, positions: changed(mesh.positions, 0, Number.POSITIVE_INFINITY) } },
    "NON_FINITE",
    "mesh.positions",
    /Infinity.*vertex 0/,
  ],
  ["a mesh without area", { mesh: scaled(0, 0, 0) }, "DEGENERATE_MESH", "mesh", /./],
  ["a planar mesh", { mesh: scaled(1, 1, 0) }, "DEGENERATE_MESH", "mesh", /./],
  ["a needle", { mesh: scaled(1, 0, 0) }, "DEGENERATE_MESH", "mesh", /./],
];

const hostile = Buffer.alloc(100);
hostile.write("glTF", "latin1");
hostile.writeUInt32LE(2, 4);
hostile.writeUInt32LE(0xffffffff, 8);
hostile.writeUInt32LE(0xfffffff0, 12);
hostile.write("JSON", 16, "latin1");
/** A GLB whose geometry is there in compressed form only. */
function compressedBy(extension: string): Uint8Array {
  const plain = gltfJson(mesh);
  const isDraco = extension.startsWith("KHR");
  const primitive = {
    ...plain.meshes[0]?.primitives[0],
    extensions: { [extension]: { bufferView: 0, attributes: {} } },
  };
  const bufferViews = plain.bufferViews.map((view) => ({
    ...view,
    buffer: 1,
    extensions: { [extension]: { ...view, buffer: 0, mode: "ATTRIBUTES", count: 1, byteStride: 12 } },
  }));
  const changes = isDraco
    ? { meshes: [{ primitives: [primitive] }], accessors: plain.accessors.map(({ bufferView: _, ...rest }) => rest) }
    : {
        bufferViews,
        buffers: [...plain.buffers, { byteLength: 1e6, extensions: { [extension]: { fallback: true } } }],
      };
  const names = { extensionsUsed: [extension], extensionsRequired: [extension] };
  return glbOf({ ...plain, ...changes, ...names }, gltfBuffer(mesh));
}
const draco = compressedBy("KHR_draco_mesh_compression");
const meshopt = compressedBy("EXT_meshopt_compression");
const external = Buffer.from(JSON.stringify(gltfJson(mesh, {}, { uri: "mesh.bin" })));
const claims = { ...gltfJson(mesh), accessors: gltfJson(mesh).accessors.map((a) => ({ ...a, count: 2 ** 31 })) };
const bytes = new Uint8Array(pixels).fill(80);
const sized = { width: undefined, height: undefined };

const files: Bad[] = [
  ["8-bit PNG depth", { ...sized, depth: png(bytes, width, height) }, "EIGHT_BIT_DEPTH", "depth", /8-bit PNG/],
  ["8-bit NPY depth", { ...sized, depth: npy(bytes, height, width) }, "EIGHT_BIT_DEPTH", "depth", /8-bit/],
  [
    "depth of no known format",
    { ...sized, depth: Buffer.from("II*\0 a TIFF") },
    "UNSUPPORTED_FORMAT",
    "depth",
    /16-bit grey PNG or a \.npy/,
  ],
  ["empty depth file", { ...sized, depth: new Uint8Array(0) }, "UNSUPPORTED_FORMAT", "depth", /./],
  ["truncated depth", { ...sized, depth: npy(depth, height, width).slice(0, 5000) }, "CORRUPT_FILE", "depth", /./],
  [
    "a depth file of another size than stated",
    { depth: npy(depth, height, width), width: 1, height: 2 },
    "SIZE_MISMATCH",
    "depth",
    /160 × 120.*1 × 2/,
  ],
  ["truncated mask", { mask: png(mask, width, height).slice(0, 60) }, "CORRUPT_FILE", "mask", /./],
  [
    "a mask file of another size",
    { mask: png(new Uint8Array(6).fill(1), 3, 2) },
    "SIZE_MISMATCH",
    "mask",
    /3 × 2 pixels/,
  ],
  [
    "RLE that does not fill its size",
    { mask: { size: [120, 160], counts: [5, 5] } },
    "CORRUPT_FILE",
    "mask.counts",
    /./,
  ],
  ["a JPEG mask", { mask: Buffer.from("\xff\xd8\xff\xe0 JFIF", "latin1") }, "UNSUPPORTED_FORMAT", "mask", /PNG/],
  ["a GLB that claims 4 GB", { mesh: hostile }, "FILE_TOO_LARGE", "mesh", /claims 4294967295 bytes; the file has 100/],
  ["truncated GLB", { mesh: glb(mesh).slice(0, 5000) }, "CORRUPT_FILE", "mesh", /./],
  ["accessors that claim too much", { mesh: glbOf(claims, gltfBuffer(mesh)) }, "FILE_TOO_LARGE", "mesh", /./],
  ["a Draco-compressed GLB", { mesh: draco }, "COMPRESSED_MESH", "mesh", /KHR_draco_mesh_compression.*gltf-transform/],
  ["a meshopt-compressed GLB", { mesh: meshopt }, "COMPRESSED_MESH", "mesh", /EXT_meshopt_compression.*gltf-transform/],
  ["a .gltf without its buffer", { mesh: external }, "INVALID_ARGUMENT", "mesh.resources", /mesh\.bin/],
  ["a mesh of no known format", { mesh: Buffer.from("hello, world") }, "UNSUPPORTED_FORMAT", "mesh", /./],
  ["an unknown mesh format", { mesh: { bytes: glb(mesh), format: "fbx" } }, "INVALID_OPTION", "mesh.format", /fbx/],
  ["an empty mesh file", { mesh: new Uint8Array(0) }, "UNSUPPORTED_FORMAT", "mesh", /./],
];

for (const [name, change, code, argument, message] of [...arrays, ...files]) {
  const call = () => aligner.align({ ...input, ...change } as AlignInput);
  test(`${name}: ${code}`, () => rejectsWith(call, { code, argument, message }));
}

const options: [name: string, options: unknown, code: ErrorCode, argument: string, message: RegExp][] = [
  ["options as text", "paper", "INVALID_ARGUMENT", "options", /string "paper"/],
  ["an unknown option", { qualty: "best" }, "UNKNOWN_OPTION", "options.qualty", /Did you mean `quality`/],
  ["an option that is like no other", { zebra: 1 }, "UNKNOWN_OPTION", "options.zebra", /one of preset, quality.*Check/],
  [
    "an option of the other preset",
    { guard: null },
    "UNKNOWN_OPTION",
    "options.guard",
    /`guard`, which is an option of preset "paper".*Pass `preset: "paper"`/,
  ],
  [
    "the same under preset paper",
    { preset: "paper", quality: "best" },
    "UNKNOWN_OPTION",
    "options.quality",
    /`quality`, which is an option of preset "precise".*Omit `preset`/,
  ],
  [
    "lockScale without the paper's method",
    { lockScale: true },
    "UNKNOWN_OPTION",
    "options.lockScale",
    /preset "paper"/,
  ],
  ["an unknown preset", { preset: "fast" }, "INVALID_OPTION", "options.preset", /precise.*paper/],
  ["a seed below 0", { seed: -1 }, "INVALID_OPTION", "options.seed", /-1/],
  ["a fractional seed", { seed: 0.5 }, "INVALID_OPTION", "options.seed", /0\.5/],
  [
    "voxelDivisions too small",
    { preset: "paper", voxelDivisions: 1 },
    "INVALID_OPTION",
    "options.voxelDivisions",
    /from 5 to 200/,
  ],
  [
    "voxelDivisions as NaN",
    { preset: "paper", voxelDivisions: Number.NaN },
    "INVALID_OPTION",
    "options.voxelDivisions",
    /NaN/,
  ],
  [
    "voxelDivisions as text",
    { preset: "paper", voxelDivisions: "30" },
    "INVALID_OPTION",
    "options.voxelDivisions",
    /30/,
  ],
  [
    "a guard that excludes the initial scale",
    { preset: "paper", guard: [1.2, 1.5] },
    "INVALID_OPTION",
    "options.guard",
    /≤ 1 ≤/,
  ],
  ["a guard of one number", { preset: "paper", guard: [0.5] }, "INVALID_OPTION", "options.guard", /./],
  [
    "an unknown guard mode",
    { preset: "paper", guardMode: "ignore" },
    "INVALID_OPTION",
    "options.guardMode",
    /reject.*clamp/,
  ],
  [
    "too many iterations",
    { preset: "paper", ransacIterations: 1e12 },
    "INVALID_OPTION",
    "options.ransacIterations",
    /./,
  ],
  ["lockScale as a number", { preset: "paper", lockScale: 1 }, "INVALID_OPTION", "options.lockScale", /./],
  ["an unknown quality", { quality: "ultra" }, "INVALID_OPTION", "options.quality", /"ultra".*fast.*balanced.*best/],
  ["a scale of zero", { scale: 0 }, "INVALID_OPTION", "options.scale", /number above 0/],
  ["a scale as another word", { scale: "fixed" }, "INVALID_OPTION", "options.scale", /"fixed".*"free"/],
  ["bounds the wrong way round", { scale: [2, 1] }, "INVALID_OPTION", "options.scale", /\[2, 1\].*min ≤ max/],
  ["bounds by name", { scale: { min: 1, max: 2 } }, "INVALID_OPTION", "options.scale", /\[min, max\]/],
  ["a scale of null", { scale: null }, "INVALID_OPTION", "options.scale", /null.*"free"/],
  ["a known extent below 0", { knownExtentM: -0.1 }, "INVALID_OPTION", "options.knownExtentM", /-0\.1.*above 0/],
  ["an unknown side", { knownExtentAxis: "w" }, "INVALID_OPTION", "options.knownExtentAxis", /longest.*z/],
  ["two known sizes", { scale: 1, knownExtentM: 1 }, "INVALID_OPTION", "options.knownExtentM", /omit one of the two/],
  ["up as zero", { cameraUp: [0, 0, 0], meshUp: [0, 1, 0] }, "INVALID_OPTION", "options.cameraUp", /not all 0/],
  ["up of two numbers", { cameraUp: [0, 1] }, "INVALID_OPTION", "options.cameraUp", /Array of 2.*three/],
  ["up with NaN", { meshUp: [0, Number.NaN, 1] }, "INVALID_OPTION", "options.meshUp", /NaN/],
  ["up in the camera alone", { cameraUp: [0, -1, 0] }, "INVALID_OPTION", "options.meshUp", /in both frames/],
  ["up in the mesh alone", { meshUp: [0, 1, 0] }, "INVALID_OPTION", "options.cameraUp", /in both frames/],
  ["an unknown symmetry", { symmetry: "round" }, "INVALID_OPTION", "options.symmetry", /"round".*"auto-revolution"/],
  ["a symmetry of null", { symmetry: null }, "INVALID_OPTION", "options.symmetry", /null.*"none"/],
  ["an axis of zero", { symmetry: [{ axis: [0, 0, 0] }] }, "INVALID_OPTION", "options.symmetry.axis", /other than 0/],
  ["a fold of 1", { symmetry: [{ axis: [0, 0, 1], fold: 1 }] }, "INVALID_OPTION", "options.symmetry.fold", /2 to 360/],
  ["an unknown search", { search: "nearby" }, "INVALID_OPTION", "options.search", /global.*local/],
  ["a local search from nowhere", { search: "local" }, "INVALID_OPTION", "options.search", /without an initial pose/],
  ["an initial pose that is none", { initial: 5 }, "INVALID_ARGUMENT", "options.initial", /number 5.*matrix/],
  ["an initial pose without parts", { initial: {} }, "INVALID_ARGUMENT", "options.initial", /scale, rotation, transl/],
  [
    "an initial pose of no scale",
    { initial: { ...truth, scale: 0 } },
    "INVALID_TRANSFORM",
    "options.initial",
    /above 0/,
  ],
  [
    "an initial pose with no rotation",
    { initial: { ...truth, rotation: [0, 0, 0, 0] } },
    "INVALID_TRANSFORM",
    "options.initial.rotation",
    /quaternion/,
  ],
  [
    "an initial pose beyond the scale's bounds",
    { initial: truth, scale: [0.1, 0.2] },
    "INVALID_OPTION",
    "options.initial",
    /0\.09.*within `scale`: \[0\.1, 0\.2\]/,
  ],
  ["a budget of zero", { workBudget: 0 }, "INVALID_OPTION", "options.workBudget", /above 0/],
  ["metrics as a word", { metrics: "none" }, "INVALID_OPTION", "options.metrics", /true or false/],
  ["onProgress as text", { onProgress: "log" }, "INVALID_ARGUMENT", "options.onProgress", /function/],
];

for (const [name, value, code, argument, message] of options) {
  const call = () => aligner.align(input, value as AlignOptions);
  test(`${name}: ${code}`, () => rejectsWith(call, { code, argument, message }));
}

test("no input at all", async () => {
  for (const nothing of [undefined, null, 5, "case", []]) {
    const call = () => aligner.align(nothing as unknown as AlignInput);
    await rejectsWith(call, { code: "INVALID_ARGUMENT", argument: "input", message: /depth, mask, mesh, camera/ });
  }
});

test("millimetres passed as metres are warned of", async () => {
  const millimetres = { ...input, depth: depth.map((z) => 1000 * z) };
  const inMillimetres = { ...truth, scale: 1000 * truth.scale, translation: truth.translation.map((x) => 1000 * x) };
  const { warnings } = await aligner.evaluate(millimetres, inMillimetres);
  assert.deepEqual(
    warnings.map(({ code }) => code),
    ["DEPTH_LOOKS_LIKE_MILLIMETRES"],
  );
  assert.match(warnings[0]?.message ?? "", /0\.001/);
});

test("a mask at the border and sparse depth are warned of", async () => {
  const sparse = depth.map((z, i) => (mask[i] !== 0 && i % 3 > 0 ? 0 : z));
  const atBorder = changed(mask, 0, 1);
  const { warnings } = await aligner.evaluate({ ...input, depth: sparse, mask: atBorder }, truth);
  assert.deepEqual(warnings.map(({ code }) => code).sort(), ["MASK_TOUCHES_BORDER", "SPARSE_DEPTH"]);
});

test("evaluate checks its input as align does", async () => {
  const bad = [
    [withoutDepth, "depth"],
    [withoutMesh, "mesh"],
  ] as const;
  for (const [wrong, argument] of bad) {
    const call = () => aligner.evaluate(wrong as unknown as AlignInput, truth);
    await rejectsWith(call, { code: "INVALID_ARGUMENT", argument, message: /nothing/ });
  }
});

after(async () => {
  assert.deepEqual((await aligner.evaluate(input, truth)).metrics, reference, "after all that, the aligner works on");
});
