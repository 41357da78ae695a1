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
  "depth as a list in an object: INVALID_ARGUMENT depth.data": [
    { depth: { data: [1], ...size } },
    /Float32Array\.from/,
  ],
  "8-bit depth: EIGHT_BIT_DEPTH depth": [{ depth: new Uint8Array(pixels).fill(9) }, /256 levels/],
  "depth too short: WRONG_LENGTH depth": [{ depth: depth.slice(1) }, /19199 values.*160 × 120 = 19200/],
  "depth of no size: EMPTY_IMAGE depth": [{ depth: new Float32Array(0), width: 0, height: 0 }, /0 × 0 pixels/],
  "depth beyond the memory: OUT_OF_MEMORY depth": [
    { depth: new Float32Array(8193 ** 2), width: 8193, height: 8193 },
    /an array of 269 MB, expected at most 268 MB/,
  ],
  "width missing: INVALID_ARGUMENT width": [{ width: undefined }, /nothing/],
  "width as a fraction: INVALID_ARGUMENT width": [{ width: 160.5 }, /160\.5/],
  "width as text: INVALID_ARGUMENT width": [{ width: "160" }, /string/],
  "an absurd size: INVALID_ARGUMENT width": [{ width: 4e9, height: 4e9 }, /4000000000/],
  "sizes that contradict: SIZE_MISMATCH depth": [{ depth: { data: depth, ...size }, width: 99 }, /99 × 120/],
  "a depth scale of zero: INVALID_ARGUMENT depthScale": [{ depthScale: 0 }, /found 0/],
  "a depth scale as text: INVALID_ARGUMENT depthScale": [{ depthScale: "mm" }, /string/],
  "an unknown kind of depth: INVALID_ARGUMENT depthKind": [{ depthKind: "relative" }, /"affine-invariant-disparity"/],
  "disparity that is nothing: NO_DEPTH_IN_MASK depth": [
    { depthKind: "affine-invariant-disparity", depth: depth.map(() => Number.NaN) },
    /no reading/,
  ],
  "a misspelt property: INVALID_ARGUMENT input.depth_scale": [{ depth_scale: 0.001 }, /depthScale/],
  "a point map beside depth: INVALID_ARGUMENT depth": [{ pointMap: new Float32Array(3 * pixels) }, /not both/],
  "mask missing: INVALID_ARGUMENT mask": [{ mask: undefined }, /found nothing, expected a Uint8Array/],
  "mask as a plain array: INVALID_ARGUMENT mask": [{ mask: Array.from(mask) }, /Uint8Array\.from\(mask\)/],
  "mask as floats: INVALID_ARGUMENT mask": [{ mask: Float32Array.from(mask) }, /Uint8Array\.from\(mask\)/],
  "mask too short: WRONG_LENGTH mask": [{ mask: mask.slice(1) }, /19199 values.*160 × 120/],
  "an RGBA mask: WRONG_LENGTH mask": [
    { mask: new Uint8ClampedArray(4 * pixels) },
    /76800 values, 4 per pixel.*one channel/,
  ],
  "an RGB mask: WRONG_LENGTH mask.data": [{ mask: { data: new Uint8Array(3 * pixels), ...size } }, /i % 3 === 0/],
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
  "camera as a number: INVALID_ARGUMENT camera": [{ camera: 600 }, /number 600/],
  "camera as null: INVALID_ARGUMENT camera": [{ camera: null }, /null/],
  "camera with NaN: INVALID_CAMERA camera.cx": [{ camera: { ...camera, cx: Number.NaN } }, /NaN/],
  "camera with fx of zero: INVALID_CAMERA camera.fx": [{ camera: { ...camera, fx: 0 } }, /found 0/],
  "camera with negative fy: INVALID_CAMERA camera.fy": [{ camera: { ...camera, fy: -600 } }, /-600/],
  "camera with fx missing: INVALID_ARGUMENT camera.fx": [{ camera: { fy: 1, cx: 1, cy: 1, fx: undefined } }],
  "K column by column: INVALID_CAMERA camera.K": [{ camera: { K: [300, 0, 0, 0, 300, 0, 80, 60, 1] } }, /transpose/],
  "K of eight numbers: WRONG_LENGTH camera.K": [{ camera: { K: [1, 2, 3, 4, 5, 6, 7, 8] } }, /9 numbers|3 × 3|3×3/],
  "a field of view of 180°: INVALID_CAMERA camera.fovYDeg": [{ camera: { fovYDeg: 180 } }, /below 180/],
  "an uncertainty of 100 %: INVALID_ARGUMENT camera.focalUncertainty": [
    { camera: { ...camera, focalUncertainty: 100 } },
    /0\.1 for 10 %/,
  ],
  "a camera of another image: SIZE_MISMATCH camera": [{ camera: { ...camera, width: 640, height: 480 } }, /640 × 480/],
  "a camera file as camera: INVALID_ARGUMENT camera": [{ camera: { cam_K: [] } }, /cameraFile/],
  "a camera with other names: INVALID_ARGUMENT camera": [{ camera: { focal: 600 } }, /\{ fx, fy, cx, cy \}.*`focal`/],
  "camera text: INVALID_ARGUMENT camera": [{ camera: "{}" }, /cameraFile/],
  "camera and camera file: INVALID_ARGUMENT cameraFile": [{ cameraFile: "{}" }, /not both/],
  "a camera file that is no JSON: CORRUPT_FILE cameraFile": [{ camera: undefined, cameraFile: "fx=600" }, /JSON/],
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
  "positions as doubles: INVALID_ARGUMENT mesh.positions": [positioned(new Float64Array(9)), /Float32Array\.from/],
  "positions not in threes: WRONG_LENGTH mesh.positions": [positioned(mesh.positions.slice(1)), /multiple of 3/],
  "indices as a plain array: INVALID_ARGUMENT mesh.indices": [indexed([0, 1, 2]), /Uint32Array\.from/],
  "indices not in threes: WRONG_LENGTH mesh.indices": [indexed(mesh.indices.slice(1)), /multiple of 3/],
  "an index out of range: INDEX_OUT_OF_RANGE mesh.indices": [
    indexed(changed(mesh.indices, 7, 1e6)),
    /1000000 in triangle 2/,
  ],
  "no triangle: EMPTY_MESH mesh": [indexed(new Uint32Array(0)), /no triangle/],
  "no vertex: EMPTY_MESH mesh": [{ mesh: { positions: new Float32Array(0) } }, /no triangle/],
  "a NaN vertex: NON_FINITE mesh.positions": [positioned(changed(mesh.positions, 4, Number.NaN)), /NaN.*vertex 1/],
  "an infinite vertex: NON_FINITE mesh.positions": [
    positioned(changed(mesh.positions, 0, 1 / 0)),
    /Infinity.*vertex 0/,
  ],
  "a mesh without area: DEGENERATE_MESH mesh": [flattened(0, 0, 0)],
  "a planar mesh: DEGENERATE_MESH mesh": [flattened(1, 1, 0)],
  "a needle: DEGENERATE_MESH mesh": [flattened(1, 0, 0)],
  "colours as a plain array: INVALID_ARGUMENT mesh.colors": [colored({ colors: [0, 0, 0] })],
  "too few colours: WRONG_LENGTH mesh.colors": [colored({ colors: new Uint8Array(6) })],
  "an unknown space of colours: INVALID_OPTION mesh.colorSpace": [
    colored({ colors: new Uint8Array(mesh.positions.length), colorSpace: "rgb" }),
  ],
  "samples as a number: INVALID_ARGUMENT mesh.samples": [colored({ samples: 7 })],
  "samples without normals: INVALID_ARGUMENT mesh.samples.normals": [
    colored({ samples: { ...samples, normals: undefined } }),
  ],
  "samples of other lengths: WRONG_LENGTH mesh.samples": [
    colored({ samples: { ...samples, colors: new Uint8Array(5) } }),
  ],
  "a photo as a number: INVALID_ARGUMENT image": [{ image: 7 }],
  "a photo of floats: INVALID_ARGUMENT image": [{ image: new Float32Array(3 * pixels) }],
  "a photo without pixels: INVALID_ARGUMENT image": [{ image: size }],
  "a photo without height: INVALID_ARGUMENT image.height": [{ image: { data: rgb, width } }],
  "a photo with too few pixels: WRONG_LENGTH image.data": [{ image: { data: rgb.subarray(3), ...size } }],
  "a photo of two channels: WRONG_LENGTH image": [{ image: new Uint8ClampedArray(2 * pixels) }],
  "a photo of another shape: SIZE_MISMATCH image": [{ image: { data: rgb, width: pixels, height: 1 } }],
});

/** A GLB whose geometry is there in compressed form only. */
function compressedBy(extension: string): Uint8Array {
  const plain = gltfJson(mesh);
  const isDraco = extension.startsWith("KHR");
  const own = { [extension]: { bufferView: 0, attributes: {} } };
  const primitive = { ...plain.meshes[0]?.primitives[0], extensions: own };
  const bufferViews = plain.bufferViews.map((of) => ({
    ...{ ...of, buffer: 1 },
    extensions: { [extension]: { ...of, buffer: 0, mode: "ATTRIBUTES", count: 1, byteStride: 12 } },
  }));
  const fallback = { byteLength: 1e6, extensions: { [extension]: { fallback: true } } };
  const changes = isDraco
    ? { meshes: [{ primitives: [primitive] }], accessors: plain.accessors.map(({ bufferView: _, ...rest }) => rest) }
    : { bufferViews, buffers: [...plain.buffers, fallback] };
  const names = { extensionsUsed: [extension], extensionsRequired: [extension] };
  return glbOf({ ...plain, ...changes, ...names }, gltfBuffer(mesh));
}

const header = Buffer.alloc(100);
header.write("glTF\x02\0\0\0\xff\xff\xff\xff\xf0\xff\xff\xffJSON", "latin1");
const claims = { ...gltfJson(mesh), accessors: gltfJson(mesh).accessors.map((a) => ({ ...a, count: 2 ** 31 })) };
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
  "an empty depth file: UNSUPPORTED_FORMAT depth": [{ ...unsized, depth: new Uint8Array(0) }],
  "truncated depth: CORRUPT_FILE depth": [{ ...unsized, depth: npy(depth, height, width).slice(0, 5000) }],
  "a depth file of another size: SIZE_MISMATCH depth": [
    { depth: npy(depth, height, width), width: 1, height: 2 },
    /160 × 120.*1 × 2/,
  ],
  "truncated mask: CORRUPT_FILE mask": [{ mask: png(mask, width, height).slice(0, 60) }],
  "a mask file of another size: SIZE_MISMATCH mask": [{ mask: png(new Uint8Array(6).fill(1), 3, 2) }, /3 × 2 pixels/],
  "RLE that does not fill its size: CORRUPT_FILE mask.counts": [{ mask: { size: [120, 160], counts: [5, 5] } }],
  "a JPEG mask: UNSUPPORTED_FORMAT mask": [{ mask: Buffer.from("\xff\xd8\xff\xe0 JFIF", "latin1") }, /PNG/],
  "a GLB that claims 4 GB: FILE_TOO_LARGE mesh": [{ mesh: header }, /claims 4294967295 bytes; the file has 100/],
  "truncated GLB: CORRUPT_FILE mesh": [{ mesh: glb(mesh).slice(0, 5000) }],
  "accessors that claim too much: FILE_TOO_LARGE mesh": [{ mesh: glbOf(claims, gltfBuffer(mesh)) }],
  "a Draco-compressed GLB: COMPRESSED_MESH mesh": [
    { mesh: compressedBy("KHR_draco_mesh_compression") },
    /KHR_draco_mesh_compression.*gltf-transform/,
  ],
  "a meshopt-compressed GLB: COMPRESSED_MESH mesh": [
    { mesh: compressedBy("EXT_meshopt_compression") },
    /EXT_meshopt_compression.*gltf-transform/,
  ],
  "a .gltf without its buffer: INVALID_ARGUMENT mesh.resources": [{ mesh: external }, /mesh\.bin/],
  "a mesh of no known format: UNSUPPORTED_FORMAT mesh": [{ mesh: Buffer.from("hello, world") }],
  "an unknown mesh format: INVALID_OPTION mesh.format": [{ mesh: { bytes: glb(mesh), format: "fbx" } }, /fbx/],
  "a photo that claims too much: FILE_TOO_LARGE image": [{ image: huge }],
  "half a JPEG: CORRUPT_FILE image": [{ image: fixture("photo.jpg").slice(0, 300) }],
  "a WebP photo: UNSUPPORTED_FORMAT image": [{ image: Buffer.from("RIFF\0\0\0\0WEBPVP8 ") }],
});

const options: Refusals<unknown> = {
  "options as text: INVALID_ARGUMENT options": ["paper", /string "paper"/],
  "an unknown option: UNKNOWN_OPTION options.qualty": [{ qualty: "best" }, /Did you mean `quality`/],
  "an option like no other: UNKNOWN_OPTION options.zebra": [{ zebra: 1 }, /one of preset, signal, transfer/],
  "an option of createAligner: UNKNOWN_OPTION options.workers": [{ workers: 4 }, /createAligner\(\{ workers \}\)/],
  "an option of the other preset: UNKNOWN_OPTION options.guard": [{ guard: null }, /Pass `preset: "paper"`/],
  "the same under preset paper: UNKNOWN_OPTION options.quality": [
    { preset: "paper", quality: "best" },
    /Omit `preset`/,
  ],
  "an unknown preset: INVALID_OPTION options.preset": [{ preset: "fast" }, /precise.*paper/],
  "a seed below 0: INVALID_OPTION options.seed": [{ seed: -1 }, /-1/],
  "a fractional seed: INVALID_OPTION options.seed": [{ seed: 0.5 }, /0\.5/],
  "voxelDivisions too small: INVALID_OPTION options.voxelDivisions": [
    { preset: "paper", voxelDivisions: 1 },
    /5 to 200/,
  ],
  "voxelDivisions as text: INVALID_OPTION options.voxelDivisions": [{ preset: "paper", voxelDivisions: "30" }, /30/],
  "a guard without 1: INVALID_OPTION options.guard": [{ preset: "paper", guard: [1.2, 1.5] }, /≤ 1 ≤/],
  "a guard of one number: INVALID_OPTION options.guard": [{ preset: "paper", guard: [0.5] }],
  "an unknown guard mode: INVALID_OPTION options.guardMode": [
    { preset: "paper", guardMode: "ignore" },
    /reject.*clamp/,
  ],
  "too many iterations: INVALID_OPTION options.ransacIterations": [{ preset: "paper", ransacIterations: 1e12 }],
  "lockScale as a number: INVALID_OPTION options.lockScale": [{ preset: "paper", lockScale: 1 }],
  "an unknown quality: INVALID_OPTION options.quality": [{ quality: "ultra" }, /"ultra".*fast.*balanced.*best/],
  "a scale of zero: INVALID_OPTION options.scale": [{ scale: 0 }, /number above 0/],
  "a scale as another word: INVALID_OPTION options.scale": [{ scale: "fixed" }, /"fixed".*"free"/],
  "bounds the wrong way round: INVALID_OPTION options.scale": [{ scale: [2, 1] }, /\[2, 1\].*min ≤ max/],
  "bounds by name: INVALID_OPTION options.scale": [{ scale: { min: 1, max: 2 } }, /\[min, max\]/],
  "a known extent below 0: INVALID_OPTION options.knownExtentM": [{ knownExtentM: -0.1 }, /-0\.1.*above 0/],
  "an unknown side: INVALID_OPTION options.knownExtentAxis": [{ knownExtentAxis: "w" }, /longest.*z/],
  "two known sizes: INVALID_OPTION options.knownExtentM": [{ scale: 1, knownExtentM: 1 }, /omit one of the two/],
  "up as zero: INVALID_OPTION options.cameraUp": [{ cameraUp: [0, 0, 0], meshUp: [0, 1, 0] }, /not all 0/],
  "up of two numbers: INVALID_OPTION options.cameraUp": [{ cameraUp: [0, 1] }, /Array of 2.*three/],
  "up with NaN: INVALID_OPTION options.meshUp": [{ meshUp: [0, Number.NaN, 1] }, /NaN/],
  "up in the camera alone: INVALID_OPTION options.meshUp": [{ cameraUp: [0, -1, 0] }, /in both frames/],
  "up in the mesh alone: INVALID_OPTION options.cameraUp": [{ meshUp: [0, 1, 0] }, /in both frames/],
  "an unknown symmetry: INVALID_OPTION options.symmetry": [{ symmetry: "round" }, /"round".*"auto"/],
  "an axis of zero: INVALID_OPTION options.symmetry.axis": [{ symmetry: [{ axis: [0, 0, 0] }] }, /other than 0/],
  "a fold of 1: INVALID_OPTION options.symmetry.fold": [{ symmetry: [{ axis: [0, 0, 1], fold: 1 }] }, /2 to 360/],
  "an unknown search: INVALID_OPTION options.search": [{ search: "nearby" }, /global.*local/],
  "a local search from nowhere: INVALID_OPTION options.search": [{ search: "local" }, /without an initial pose/],
  "an initial pose that is none: INVALID_ARGUMENT options.initial": [{ initial: 5 }, /number 5.*matrix/],
  "an initial pose of no scale: INVALID_TRANSFORM options.initial": [{ initial: { ...truth, scale: 0 } }, /above 0/],
  "an initial pose without rotation: INVALID_TRANSFORM options.initial.rotation": [
    { initial: { ...truth, rotation: [0, 0, 0, 0] } },
    /quaternion/,
  ],
  "an initial pose beyond the bounds: INVALID_OPTION options.initial": [
    { initial: truth, scale: [0.1, 0.2] },
    /0\.09.*within `scale`: \[0\.1, 0\.2\]/,
  ],
  "a budget of zero: INVALID_OPTION options.workBudget": [{ workBudget: 0 }, /above 0/],
  "metrics as a word: INVALID_OPTION options.metrics": [{ metrics: "none" }, /true or false/],
  "onProgress as text: INVALID_ARGUMENT options.onProgress": [{ onProgress: "log" }, /function/],
  "a signal that is none: INVALID_ARGUMENT options.signal": [{ signal: { aborted: false } }, /AbortSignal/],
};
refuses(options, (value) => aligner.align(input, value as AlignOptions));

const transforms: Refusals<unknown> = {
  "no transform: INVALID_ARGUMENT transform": [undefined, /transform/],
  "a scale of zero: INVALID_TRANSFORM transform": [{ ...truth, scale: 0 }, /scale/],
  "a translation with NaN: INVALID_TRANSFORM transform": [{ ...truth, translation: [0, Number.NaN, 0] }, /finite|NaN/],
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
  "no cloud: INVALID_ARGUMENT target": [() => register(cloud, "x"), /string/],
  "a broken triple: WRONG_LENGTH source": [() => register(cloud.slice(1)), /multiple of 3/],
  "a NaN point: NON_FINITE source": [() => estimate(pairs, changed(cloud, 4, Number.NaN)), /NaN in point 1/],
  "ten points: TOO_FEW_POINTS source": [() => register(cloud.slice(0, 30)), /10 points/],
  "one point only: DEGENERATE_POINTS target": [() => register(cloud, new Float64Array(300)), /identical points/],
  "a negative scale: INVALID_OPTION options.scale": [() => register(cloud, cloud, { scale: -1 }), /"free"/],
  "a grid that is too coarse: INVALID_OPTION options.voxelDivisions": [
    () => register(cloud, cloud, { voxelDivisions: 2 }),
    /from 5 to 200, or null/,
  ],
  "an option of align: UNKNOWN_OPTION options.guard": [() => register(cloud, cloud, { guard: null })],
  "plain correspondences: INVALID_ARGUMENT correspondences": [() => estimate([0, 0]), /Uint32Array\.from/],
  "half a pair: WRONG_LENGTH correspondences": [() => estimate(pairs.slice(1)), /even/],
  "an index too far: INDEX_OUT_OF_RANGE correspondences": [
    () => estimate(Uint32Array.of(0, 0, 1, 1, 2, 1e6)),
    /pair 2/,
  ],
  "two pairs: TOO_FEW_POINTS correspondences": [() => estimate(Uint32Array.of(0, 0, 50, 50)), /at least 3/],
  "a mesh to prepare without area: DEGENERATE_MESH mesh": [
    () => aligner.prepareMesh({ positions: new Float32Array(9) }),
  ],
  "a video of unknown quality: INVALID_OPTION options.quality": [
    () => aligner.track(mesh, { quality: "nice" } as never),
  ],
  "inputs that are one: INVALID_ARGUMENT inputs": [() => drain(input), /iterable/],
  "options of createAligner as null: INVALID_ARGUMENT options": [() => createAligner(null as never), /null/],
  "a misspelt option of createAligner: UNKNOWN_OPTION worker": [
    () => createAligner({ worker: 2 } as object),
    /workers/,
  ],
  "a negative number of workers: INVALID_ARGUMENT workers": [() => createAligner({ workers: -1 }), /auto/],
  "half a worker: INVALID_ARGUMENT workers": [() => createAligner({ workers: 1.5 }), /auto/],
  "a thousand workers: INVALID_ARGUMENT workers": [() => createAligner({ workers: 1000 }), /auto/],
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
  "an unknown property of an object: INVALID_ARGUMENT objects[0].colour": [inScene({ colour: 1 })],
  "a label without label map: INVALID_ARGUMENT objects[0].label": [inScene({ mask: undefined, label: 1 })],
  "an object's mask of another size: SIZE_MISMATCH objects[0].mask": [inScene({ mask: small })],
  "a label map of another size: SIZE_MISMATCH labels": [{ ...tableScene, labels: small }],
  "an occluder of another size: WRONG_LENGTH occluders[0]": [{ ...tableScene, occluders: [new Uint8Array(3)] }],
  "a support as a word: INVALID_ARGUMENT support": [{ ...tableScene, support: "floor" }],
  "a normal of zero: INVALID_ARGUMENT support.normal": [{ ...tableScene, support: { normal: [0, 0, 0], d: 1 } }],
};
refuses(scenes, (scene) => aligner.alignScene(scene as never, quick));

const sceneOptions: Refusals<object> = {
  "the paper's method for a scene: INVALID_OPTION options.preset": [{ preset: "paper" }],
  "one first pose for a scene: UNKNOWN_OPTION options.initial": [{ initial: poses[0] }],
  "a scene's scale below 0: INVALID_OPTION options.scale": [{ scale: -1 }],
};
refuses(sceneOptions, (options) => aligner.alignScene(tableScene, options as never));

const still = { scale: 1, rotation: [0, 0, 0, 1], translation: [0, 0, 0] };
const { mesh: _, ...frame } = input;
const views: Refusals<object> = {
  "no views: INVALID_ARGUMENT views": [{ views: undefined }],
  "a list of no views: INVALID_ARGUMENT views": [{ views: [] }],
  "one camera pose of two: INVALID_ARGUMENT views": [{ views: [{ ...frame, cameraToWorld: still }, frame] }],
  "a misspelt property of a view: INVALID_ARGUMENT views[1].depht": [{ views: [frame, { ...frame, depht: 1 }] }],
  "a view's depth as a list: INVALID_ARGUMENT views[1].depth": [{ views: [frame, { ...frame, depth: [1, 2] }] }],
  "an empty mask of a view: EMPTY_MASK views[1].mask": [{ views: [frame, { ...frame, mask: new Uint8Array(pixels) }] }],
  "a camera with a scale: INVALID_TRANSFORM views[0].cameraToWorld": [
    { views: [{ ...frame, cameraToWorld: { ...still, scale: 2 } }] },
  ],
  "a view's photo of another shape: SIZE_MISMATCH views[1].image": [
    { views: [frame, { ...frame, image: { data: rgb, width: pixels, height: 1 } }] },
    /field of view/,
  ],
  "a view as a number: INVALID_ARGUMENT views[0]": [{ views: [7] }],
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
