/** Bad arguments of every call: a typed error with its code, the argument, and what to do; and an aligner that works on. */
import assert from "node:assert/strict";
import { after, test } from "node:test";
import { type AlignInput, type AlignOptions, createAligner, type Sim3Like } from "sim3align";
import { type Refusals, refuses, rejectsWith } from "../support/errors.js";
import { fixture, glb, glbOf, gltfBuffer, gltfJson, npy, png } from "../support/files.js";
import { withoutTimes } from "../support/results.js";
import { input, mesh, truth, view } from "../support/scene.js";
import { poses, tableScene, tableView } from "../support/table.js";

const aligner = await createAligner();
const quick = { quality: "fast" } as const;
const expected = withoutTimes(await aligner.align(input, quick));
after(async () => assert.deepEqual(withoutTimes(await aligner.align(input, quick)), expected, "the aligner works on"));

const { width, height, depth, mask, camera } = view;
const pixels = width * height;
const size = { width, height };
const inMask = (value: number) => depth.map((z, i) => (mask[i] === 0 ? z : value));

/** An array with another value at an index. */
function changed<T extends { slice(): T; [index: number]: number }>(array: T, index: number, value: number): T {
  const copy = array.slice();
  copy[index] = value;
  return copy;
}

const refusesInputs = (changes: Refusals<object>) =>
  refuses(changes, (change) => aligner.align({ ...input, ...change } as AlignInput));

refusesInputs({
  "depth missing: INVALID_ARGUMENT depth": [{ depth: undefined }, /found nothing, expected a Float32Array/],
  "depth as a plain array: INVALID_ARGUMENT depth": [
    { depth: Array.from(depth) },
    /19200.*Float32Array\.from\(depth\)/,
  ],
  "depth as doubles: INVALID_ARGUMENT depth": [{ depth: Float64Array.from(depth) }, /Float32Array\.from\(depth\)/],
  "8-bit depth: EIGHT_BIT_DEPTH depth": [{ depth: new Uint8Array(pixels).fill(9) }, /256 levels/],
  "depth too short: WRONG_LENGTH depth": [{ depth: depth.slice(1) }, /19199 values.*160 × 120 = 19200/],
  "depth beyond the memory: OUT_OF_MEMORY depth": [
    { depth: new Float32Array(8193 ** 2), width: 8193, height: 8193 },
    /an array of 269 MB, expected at most 268 MB/,
  ],
  "width missing: INVALID_ARGUMENT width": [{ width: undefined }, /nothing/],
  "width as a fraction: INVALID_ARGUMENT width": [{ width: 160.5 }, /160\.5/],
  "sizes that contradict: SIZE_MISMATCH depth": [{ depth: { data: depth, ...size }, width: 99 }, /99 × 120/],
  "a depth scale of zero: INVALID_ARGUMENT depthScale": [{ depthScale: 0 }, /found 0/],
  "an unknown kind of depth: INVALID_ARGUMENT depthKind": [{ depthKind: "relative" }, /"affine-invariant-disparity"/],
  "a misspelt property: INVALID_ARGUMENT input.depth_scale": [{ depth_scale: 0.001 }, /depthScale/],
  "a point map beside depth: INVALID_ARGUMENT depth": [{ pointMap: new Float32Array(3 * pixels) }, /not both/],
  "mask missing: INVALID_ARGUMENT mask": [{ mask: undefined }, /found nothing, expected a Uint8Array/],
  "mask as a plain array: INVALID_ARGUMENT mask": [{ mask: Array.from(mask) }, /Uint8Array\.from\(mask\)/],
  "mask as floats: INVALID_ARGUMENT mask": [{ mask: Float32Array.from(mask) }, /Uint8Array\.from\(mask\)/],
  "an RGBA mask: WRONG_LENGTH mask": [
    { mask: new Uint8ClampedArray(4 * pixels) },
    /76800 values, 4 per pixel.*one channel/,
  ],
  "a mask as ImageData: INVALID_ARGUMENT mask": [{ mask: { [Symbol.toStringTag]: "ImageData" } }, /one channel/],
  "mask of another size: SIZE_MISMATCH mask": [
    { mask: { data: new Uint8Array(80 * 60), width: 80, height: 60 } },
    /80 × 60 pixels.*160 × 120.*resizeMask/s,
  ],
  "an unknown way of resizing: INVALID_ARGUMENT resizeMask": [{ resizeMask: "bilinear" }, /"nearest"/],
  "mask empty: EMPTY_MASK mask": [{ mask: new Uint8Array(pixels) }, /no non-zero pixel/],
  "mask without depth: NO_DEPTH_IN_MASK depth": [{ depth: inMask(0) }, /no reading in the \d+ pixels/],
  "depth all equal: FLAT_DEPTH depth": [{ depth: inMask(0.7) }, /0\.7 m in all \d+ readings/],
  "too few points: TOO_FEW_POINTS depth": [
    { mask: mask.map((m, i) => (m !== 0 && i < mask.indexOf(1) + 5 ? 1 : 0)) },
    /at least \d+/,
  ],
  "camera as null: INVALID_ARGUMENT camera": [{ camera: null }, /null/],
  "camera with NaN: INVALID_CAMERA camera.cx": [{ camera: { ...camera, cx: Number.NaN } }, /NaN/],
  "camera with fx of zero: INVALID_CAMERA camera.fx": [{ camera: { ...camera, fx: 0 } }, /found 0/],
  "K column by column: INVALID_CAMERA camera.K": [{ camera: { K: [300, 0, 0, 0, 300, 0, 80, 60, 1] } }, /transpose/],
  "an uncertainty of 100 %: INVALID_ARGUMENT camera.focalUncertainty": [
    { camera: { ...camera, focalUncertainty: 100 } },
    /0\.1 for 10 %/,
  ],
  "a camera of another image: SIZE_MISMATCH camera": [{ camera: { ...camera, width: 640, height: 480 } }, /640 × 480/],
  "a camera file as camera: INVALID_ARGUMENT camera": [{ camera: { cam_K: [] } }, /cameraFile/],
  "a camera with other names: INVALID_ARGUMENT camera": [{ camera: { focal: 600 } }, /\{ fx, fy, cx, cy \}.*`focal`/],
  "camera and camera file: INVALID_ARGUMENT cameraFile": [{ cameraFile: "{}" }, /not both/],
  "a scene camera without image id: INVALID_ARGUMENT imageId": [
    { camera: undefined, cameraFile: { "1": { cam_K: [] }, "2": { cam_K: [] } } },
    /one of 1, 2/,
  ],
});

const flattened = (x: number, y: number, z: number) => ({
  mesh: { ...mesh, positions: mesh.positions.map((value, i) => value * ([x, y, z][i % 3] ?? 0)) },
});

const positioned = (positions: unknown) => ({ mesh: { ...mesh, positions } });
const indexed = (indices: unknown) => ({ mesh: { ...mesh, indices } });
const samples = { positions: new Float32Array(6), normals: new Float32Array(6), colors: new Uint8Array(6) };
const rgb = new Uint8Array(3 * pixels);
const colored = (change: object) => ({ image: rgb, mesh: { ...mesh, ...change } });

refusesInputs({
  "mesh missing: INVALID_ARGUMENT mesh": [{ mesh: undefined }, /found nothing/],
  "positions as a plain array: INVALID_ARGUMENT mesh.positions": [positioned([0, 0, 0]), /Float32Array\.from/],
  "positions not in threes: WRONG_LENGTH mesh.positions": [positioned(mesh.positions.slice(1)), /multiple of 3/],
  "indices as a plain array: INVALID_ARGUMENT mesh.indices": [indexed([0, 1, 2]), /Uint32Array\.from/],
  "an index out of range: INDEX_OUT_OF_RANGE mesh.indices": [
    indexed(changed(mesh.indices, 7, 1e6)),
    /1000000 in triangle 2/,
  ],
  "no triangle: EMPTY_MESH mesh": [indexed(new Uint32Array(0)), /no triangle/],
  "a NaN vertex: NON_FINITE mesh.positions": [positioned(changed(mesh.positions, 4, Number.NaN)), /NaN.*vertex 1/],
  "a mesh without area: DEGENERATE_MESH mesh": [flattened(0, 0, 0)],
  "colours as a plain array: INVALID_ARGUMENT mesh.colors": [colored({ colors: [0, 0, 0] })],
  "an unknown space of colours: INVALID_OPTION mesh.colorSpace": [
    colored({ colors: new Uint8Array(mesh.positions.length), colorSpace: "rgb" }),
  ],
  "samples of other lengths: WRONG_LENGTH mesh.samples": [
    colored({ samples: { ...samples, colors: new Uint8Array(5) } }),
  ],
  "a photo of floats: INVALID_ARGUMENT image": [{ image: new Float32Array(3 * pixels) }],
  "a photo without height: INVALID_ARGUMENT image.height": [{ image: { data: rgb, width } }],
  "a photo of another shape: SIZE_MISMATCH image": [{ image: { data: rgb, width: pixels, height: 1 } }],
});

/** A GLB whose geometry is there in compressed form only. */
function dracoGlb(): Uint8Array {
  const extension = "KHR_draco_mesh_compression";
  const plain = gltfJson(mesh);
  const primitive = {
    ...plain.meshes[0]?.primitives[0],
    extensions: { [extension]: { bufferView: 0, attributes: {} } },
  };
  const accessors = plain.accessors.map(({ bufferView: _, ...rest }) => rest);
  const names = { extensionsUsed: [extension], extensionsRequired: [extension] };
  return glbOf({ ...plain, meshes: [{ primitives: [primitive] }], accessors, ...names }, gltfBuffer(mesh));
}

const header = Buffer.alloc(100);
header.write("glTF\x02\0\0\0\xff\xff\xff\xff\xf0\xff\xff\xffJSON", "latin1");
const external = Buffer.from(JSON.stringify(gltfJson(mesh, {}, { uri: "mesh.bin" })));
const bytes = new Uint8Array(pixels).fill(80);
const unsized = { width: undefined, height: undefined };
const photo = fixture("photo.png");
const huge = photo.slice();
// 100 000 × 100 000 pixels.
huge.set([0, 1, 0x86, 0xa0, 0, 1, 0x86, 0xa0], 16);

refusesInputs({
  "8-bit PNG depth: EIGHT_BIT_DEPTH depth": [{ ...unsized, depth: png(bytes, width, height) }, /8-bit PNG/],
  "depth of no known format: UNSUPPORTED_FORMAT depth": [
    { ...unsized, depth: Buffer.from("BM a bitmap") },
    /16-bit grey PNG, a \.npy array, or a \.npz/,
  ],
  "truncated depth: CORRUPT_FILE depth": [{ ...unsized, depth: npy(depth, height, width).slice(0, 5000) }],
  "a mask file of another size: SIZE_MISMATCH mask": [{ mask: png(new Uint8Array(6).fill(1), 3, 2) }, /3 × 2 pixels/],
  "RLE that does not fill its size: CORRUPT_FILE mask.counts": [{ mask: { size: [120, 160], counts: [5, 5] } }],
  "a JPEG mask: UNSUPPORTED_FORMAT mask": [{ mask: Buffer.from("\xff\xd8\xff\xe0 JFIF", "latin1") }, /PNG/],
  "a GLB that claims 4 GB: FILE_TOO_LARGE mesh": [{ mesh: header }, /claims 4294967295 bytes; the file has 100/],
  "truncated GLB: CORRUPT_FILE mesh": [{ mesh: glb(mesh).slice(0, 5000) }],
  "a Draco-compressed GLB: COMPRESSED_MESH mesh": [{ mesh: dracoGlb() }, /KHR_draco_mesh_compression.*gltf-transform/],
  "a .gltf without its buffer: INVALID_ARGUMENT mesh.resources": [{ mesh: external }, /mesh\.bin/],
  "an unknown mesh format: INVALID_OPTION mesh.format": [{ mesh: { bytes: glb(mesh), format: "fbx" } }, /fbx/],
  "a photo that claims too much: FILE_TOO_LARGE image": [{ image: huge }],
  "a WebP photo: UNSUPPORTED_FORMAT image": [{ image: Buffer.from("RIFF\0\0\0\0WEBPVP8 ") }],
});

const options: Refusals<unknown> = {
  "options as text: INVALID_ARGUMENT options": ["paper", /string "paper"/],
  "an unknown option: UNKNOWN_OPTION options.qualty": [{ qualty: "best" }, /Did you mean `quality`/],
  "an option of createAligner: UNKNOWN_OPTION options.workers": [{ workers: 4 }, /createAligner\(\{ workers \}\)/],
  "an option of the other preset: UNKNOWN_OPTION options.guard": [{ guard: null }, /Pass `preset: "paper"`/],
  "the same under preset paper: UNKNOWN_OPTION options.quality": [
    { preset: "paper", quality: "best" },
    /Omit `preset`/,
  ],
  "an unknown preset: INVALID_OPTION options.preset": [{ preset: "fast" }, /precise.*paper/],
  "a seed below 0: INVALID_OPTION options.seed": [{ seed: -1 }, /-1/],
  "voxelDivisions too small: INVALID_OPTION options.voxelDivisions": [
    { preset: "paper", voxelDivisions: 1 },
    /5 to 200/,
  ],
  "a guard without 1: INVALID_OPTION options.guard": [{ preset: "paper", guard: [1.2, 1.5] }, /≤ 1 ≤/],
  "lockScale as a number: INVALID_OPTION options.lockScale": [{ preset: "paper", lockScale: 1 }],
  "an unknown quality: INVALID_OPTION options.quality": [{ quality: "ultra" }, /"ultra".*fast.*balanced.*best/],
  "a scale of zero: INVALID_OPTION options.scale": [{ scale: 0 }, /number above 0/],
  "a scale as another word: INVALID_OPTION options.scale": [{ scale: "fixed" }, /"fixed".*"free"/],
  "bounds the wrong way round: INVALID_OPTION options.scale": [{ scale: [2, 1] }, /\[2, 1\].*min ≤ max/],
  "a known extent below 0: INVALID_OPTION options.knownExtentM": [{ knownExtentM: -0.1 }, /-0\.1.*above 0/],
  "an unknown side: INVALID_OPTION options.knownExtentAxis": [{ knownExtentAxis: "w" }, /longest.*z/],
  "two known sizes: INVALID_OPTION options.knownExtentM": [{ scale: 1, knownExtentM: 1 }, /omit one of the two/],
  "up as zero: INVALID_OPTION options.cameraUp": [{ cameraUp: [0, 0, 0], meshUp: [0, 1, 0] }, /not all 0/],
  "up in the camera alone: INVALID_OPTION options.meshUp": [{ cameraUp: [0, -1, 0] }, /in both frames/],
  "an unknown symmetry: INVALID_OPTION options.symmetry": [{ symmetry: "round" }, /"round".*"auto"/],
  "an axis of zero: INVALID_OPTION options.symmetry.axis": [{ symmetry: [{ axis: [0, 0, 0] }] }, /other than 0/],
  "a local search from nowhere: INVALID_OPTION options.search": [{ search: "local" }, /without an initial pose/],
  "an initial pose that is none: INVALID_ARGUMENT options.initial": [{ initial: 5 }, /number 5.*matrix/],
  "an initial pose without rotation: INVALID_TRANSFORM options.initial.rotation": [
    { initial: { ...truth, rotation: [0, 0, 0, 0] } },
    /quaternion/,
  ],
  "an initial pose beyond the bounds: INVALID_OPTION options.initial": [
    { initial: truth, scale: [0.1, 0.2] },
    /0\.09.*within `scale`: \[0\.1, 0\.2\]/,
  ],
  "a budget of zero: INVALID_OPTION options.workBudget": [{ workBudget: 0 }, /above 0/],
  "onProgress as text: INVALID_ARGUMENT options.onProgress": [{ onProgress: "log" }, /function/],
  "a signal that is none: INVALID_ARGUMENT options.signal": [{ signal: { aborted: false } }, /AbortSignal/],
};
refuses(options, (value) => aligner.align(input, value as AlignOptions));

const transforms: Refusals<unknown> = {
  "no transform: INVALID_ARGUMENT transform": [undefined, /transform/],
  "a scale of zero: INVALID_TRANSFORM transform": [{ ...truth, scale: 0 }, /scale/],
  "a reflection: INVALID_TRANSFORM transform": [{ ...truth, rotation: [1, 0, 0, 0, 1, 0, 0, 0, -1] }, /rotation/],
  "a row-major matrix: INVALID_TRANSFORM transform.matrix": [
    [0.1, 0, 0, 1, 0, 0.1, 0, 2, 0, 0, 0.1, 3, 0, 0, 0, 1],
    /column-major/,
  ],
};
refuses(transforms, (transform) => aligner.evaluate(input, transform as Sim3Like));

const cloud = Float64Array.from(mesh.positions);
const pairs = Uint32Array.from({ length: 20 }, (_, i) => 40 * Math.floor(i / 2));
const register = (source: unknown, target: unknown = cloud, options = {}) =>
  aligner.register(source as Float64Array, target as Float64Array, options);
const estimate = (correspondences: unknown, source = cloud) =>
  aligner.estimateSim3(source, cloud, correspondences as Uint32Array);

const others: Refusals<() => Promise<unknown>> = {
  "evaluate without depth: INVALID_ARGUMENT depth": [
    () => aligner.evaluate({ ...input, depth: undefined } as never, truth),
    /nothing/,
  ],
  "a cloud as a plain array: INVALID_ARGUMENT source": [() => register([1, 2, 3]), /Float64Array\.from/],
  "a broken triple: WRONG_LENGTH source": [() => register(cloud.slice(1)), /multiple of 3/],
  "a NaN point: NON_FINITE source": [() => estimate(pairs, changed(cloud, 4, Number.NaN)), /NaN in point 1/],
  "ten points: TOO_FEW_POINTS source": [() => register(cloud.slice(0, 30)), /10 points/],
  "an option of align: UNKNOWN_OPTION options.guard": [() => register(cloud, cloud, { guard: null })],
  "plain correspondences: INVALID_ARGUMENT correspondences": [() => estimate([0, 0]), /Uint32Array\.from/],
  "half a pair: WRONG_LENGTH correspondences": [() => estimate(pairs.slice(1)), /even/],
  "an index too far: INDEX_OUT_OF_RANGE correspondences": [
    () => estimate(Uint32Array.of(0, 0, 1, 1, 2, 1e6)),
    /pair 2/,
  ],
  "a video of unknown quality: INVALID_OPTION options.quality": [
    () => aligner.track(mesh, { quality: "nice" } as never),
  ],
  "inputs that are one: INVALID_ARGUMENT inputs": [() => drain(input), /iterable/],
  "a misspelt option of createAligner: UNKNOWN_OPTION worker": [
    () => createAligner({ worker: 2 } as object),
    /workers/,
  ],
  "a negative number of workers: INVALID_ARGUMENT workers": [() => createAligner({ workers: -1 }), /auto/],
  "a script as createWorker: INVALID_ARGUMENT createWorker": [
    () => createAligner({ workers: 1, createWorker: "worker.js" as never }),
    /function/,
  ],
};
refuses(others, (call) => call());

async function drain(inputs: unknown): Promise<void> {
  for await (const _ of aligner.alignAll(inputs as AlignInput[])) assert.fail("no input");
}

const [first] = tableScene.objects;
const inScene = (change: object) => ({ ...tableScene, objects: [{ ...first, ...change }] });
const small = { data: new Uint8Array(4), width: 2, height: 2 };
const scenes: Refusals<object> = {
  "a scene of nothing: INVALID_ARGUMENT objects": [{ ...tableView, objects: [] }],
  "a scene without depth: INVALID_ARGUMENT depth": [{ ...tableScene, depth: undefined }],
  "an object without mask: INVALID_ARGUMENT objects[0].mask": [inScene({ mask: undefined })],
  "a label without label map: INVALID_ARGUMENT objects[0].label": [inScene({ mask: undefined, label: 1 })],
  "a label map of another size: SIZE_MISMATCH labels": [{ ...tableScene, labels: small }],
  "an occluder of another size: WRONG_LENGTH occluders[0]": [{ ...tableScene, occluders: [new Uint8Array(3)] }],
  "a normal of zero: INVALID_ARGUMENT support.normal": [{ ...tableScene, support: { normal: [0, 0, 0], d: 1 } }],
};
refuses(scenes, (scene) => aligner.alignScene(scene as never, quick));

const sceneOptions: Refusals<object> = {
  "the paper's method for a scene: INVALID_OPTION options.preset": [{ preset: "paper" }],
  "one first pose for a scene: UNKNOWN_OPTION options.initial": [{ initial: poses[0] }],
};
refuses(sceneOptions, (options) => aligner.alignScene(tableScene, options as never));

const still = { scale: 1, rotation: [0, 0, 0, 1], translation: [0, 0, 0] };
const { mesh: _, ...frame } = input;
const views: Refusals<object> = {
  "no views: INVALID_ARGUMENT views": [{ views: undefined }],
  "one camera pose of two: INVALID_ARGUMENT views": [{ views: [{ ...frame, cameraToWorld: still }, frame] }],
  "a misspelt property of a view: INVALID_ARGUMENT views[1].depht": [{ views: [frame, { ...frame, depht: 1 }] }],
  "a view's depth as a list: INVALID_ARGUMENT views[1].depth": [{ views: [frame, { ...frame, depth: [1, 2] }] }],
  "a camera with a scale: INVALID_TRANSFORM views[0].cameraToWorld": [
    { views: [{ ...frame, cameraToWorld: { ...still, scale: 2 } }] },
  ],
  "a view's photo of another shape: SIZE_MISMATCH views[1].image": [
    { views: [frame, { ...frame, image: { data: rgb, width: pixels, height: 1 } }] },
    /field of view/,
  ],
  "depth beside views: INVALID_ARGUMENT input.depth": [{ views: [frame], depth: 1 }],
};
refuses(views, (change) => aligner.alignViews({ mesh, ...change } as never));

test("no input at all", async () => {
  for (const nothing of [undefined, null, 5, "case", []]) {
    await rejectsWith(() => aligner.align(nothing as never), "INVALID_ARGUMENT input", /depth, mask, mesh, camera/);
  }
});

test("memory that is detached, getters that throw, and what cannot be sent, with and without workers", async () => {
  const detached = structuredClone(depth);
  structuredClone(detached, { transfer: [detached.buffer] });
  const throwing = Object.defineProperty({ ...input }, "mask", {
    enumerable: true,
    get: () => assert.fail("not loaded yet"),
  });
  using pool = await createAligner({ workers: 1 });
  for (const one of [aligner, pool]) {
    await rejectsWith(() => one.align({ ...input, depth: detached }), "INVALID_ARGUMENT depth", /detached.*transfer/);
    await rejectsWith(() => one.align(throwing), "INVALID_ARGUMENT mask", /throws .*not loaded yet/);
    await rejectsWith(() => one.align({ ...input, mesh: (() => mesh) as never }), "INVALID_ARGUMENT mesh");
    await rejectsWith(() => one.align(input, { seed: Symbol("s") as never }), "INVALID_OPTION options.seed");
    const reactive = new Proxy(input, { get: (target, name) => Reflect.get(target, name) });
    assert.deepEqual(withoutTimes(await one.align(reactive, quick)), expected, "a forwarding proxy is its target");
  }
});
