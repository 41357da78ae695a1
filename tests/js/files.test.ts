/** Files of other programs, read through `sim3align/formats`: depth, masks, meshes, and photos with their EXIF data. */
import assert from "node:assert/strict";
import { test } from "node:test";
import type { MeshFile } from "sim3align";
import { placeSplats } from "sim3align/conventions";
import {
  type DepthImage,
  type Exif,
  externalResources,
  focalFromExif,
  type ReadDepthOptions,
  readCase,
  readDepth,
  readExif,
  readImage,
  readMask,
  readMesh,
} from "sim3align/formats";
import { glbFrom, meshoptGltf } from "../support/compressed.js";
import { rejectsWith } from "../support/errors.js";
import { type ExifFields, jpegHead, pngWith, tiff } from "../support/exif.js";
import { cocoRle, fixture, gltfJson, npy, obj, png } from "../support/files.js";
import { mesh } from "../support/scene.js";

const relative = { depthKind: "affine-invariant-disparity" } as const;
type Unit = DepthImage["unit"];
const unitOf = (metres: number | null, source: string, isAssumed = false): Unit => ({ metres, source, isAssumed });

test("kinds of depth: what their values mean", async () => {
  const file = npy(Float32Array.of(0, -2, Number.NaN, 0.5, Number.POSITIVE_INFINITY, 3), 2, 3);
  const read = async (options: ReadDepthOptions) => Array.from((await readDepth(file, options)).data);
  assert.deepEqual(await read({}), [0, 0, 0, 0.5, 0, 3]);
  assert.deepEqual(await read({ depthKind: "scale-invariant", depthScale: 2 }), [0, 0, 0, 1, 0, 6]);
  for (const depthKind of ["affine-invariant", "affine-invariant-disparity"] as const) {
    assert.deepEqual(await read({ depthKind }), [0, -2, Number.NaN, 0.5, Number.NaN, 3]);
  }
  const picture = png(Uint8Array.of(0, 7, 255, 1), 2, 2);
  const { data, unit } = await readDepth(picture, relative);
  assert.deepEqual([...data, unit], [0, 7, 255, 1, unitOf(null, "affine-invariant-disparity")]);
  const integers = await readDepth(fixture("depth-16-pillow.png"), { integerDepthScale: 0.0001 });
  assert.deepEqual(integers.unit, unitOf(0.0001, "camera file"));
  assert.deepEqual(
    (await readDepth(fixture("depth-uint16.tiff"), { depthScale: 0.0002 })).unit,
    unitOf(0.0002, "depthScale"),
  );
  const { camera, unit: assumed } = await readDepth(fixture("depth-da3.npz"));
  assert.deepEqual([camera?.fx, assumed], [40, unitOf(1, "float values", true)]);
  const eightBit = { code: "EIGHT_BIT_DEPTH", argument: "depth", message: /depthKind "affine-invariant-disparity"/ };
  await assert.rejects(readDepth(picture), eightBit);
  const unknown = { code: "INVALID_OPTION", argument: "options.depthKind", message: /"scale-invariant"/ };
  for (const depthKind of ["relative", 7])
    await assert.rejects(readDepth(picture, { depthKind: depthKind as never }), unknown);
  await assert.rejects(readDepth("depth.npy" as never), { code: "INVALID_ARGUMENT", argument: "file" });
});

test("masks in JSON are those of pycocotools; run lengths that do not fit are refused", async () => {
  // The object is where (u² + 3 v) mod 5 < 2, of 7 × 5 pixels.
  const expected = Uint8Array.from({ length: 35 }, (_, i) => (((i % 7) ** 2 + 3 * Math.floor(i / 7)) % 5 < 2 ? 1 : 0));
  for (const name of ["rle-small.json", "rle-small-plain.json"]) {
    const json = JSON.parse(Buffer.from(fixture(name)).toString());
    const annotation = Buffer.from(`\ufeff ${JSON.stringify({ id: 1, segmentation: json })}`);
    for (const file of [fixture(name), json, annotation]) assert.deepEqual((await readMask(file)).data, expected, name);
  }
  const refused: [size: string, counts: string, code: string, argument: string][] = [
    ["[5,7]", "[36]", "CORRUPT_FILE", "mask.counts"],
    ["[5,7]", "[30,4]", "CORRUPT_FILE", "mask.counts"],
    ["[5,7]", "{}", "INVALID_ARGUMENT", "mask.counts"],
    ["[0,7]", "[0]", "EMPTY_IMAGE", "mask.size"],
    ["[5,7,1]", "[35]", "WRONG_LENGTH", "mask.size"],
  ];
  for (const [size, counts, code, argument] of refused) {
    await assert.rejects(readMask(Buffer.from(`{"size":${size},"counts":${counts}}`)), { code, argument }, counts);
  }
  assert.deepEqual((await readMask(cocoRle(expected, 7, 5))).data, expected);
});

test("the files that a mesh refers to are named", async () => {
  const gltf = Buffer.from(JSON.stringify(gltfJson(mesh, {}, { uri: "a%20b.bin" })));
  assert.deepEqual(await externalResources(gltf), { shape: ["a%20b.bin"], colors: [] });
  const named = Buffer.concat([Buffer.from("mtllib my.mtl\nmtllib C:\\away.mtl\n"), obj(mesh)]);
  assert.deepEqual(await externalResources(named), { shape: [], colors: ["C:/away.mtl", "my.mtl"] });
  const ply = Buffer.from("ply\nformat ascii 1.0\ncomment TextureFile my picture.png\nend_header\n");
  assert.deepEqual(await externalResources(ply), { shape: [], colors: ["my picture.png"] });
  await assert.rejects(readMesh(Uint8Array.of(1, 2, 3)), { code: "UNSUPPORTED_FORMAT" });
});

test("meshes and splats in other formats are named, with a way to convert them", async () => {
  const gaussians = JSON.stringify({ asset: { version: "2.0" }, extensionsUsed: ["KHR_gaussian_splatting"] });
  const files: readonly (readonly [beginning: string, found: RegExp])[] = [
    ['<?xml version="1.0"?>\n<COLLADA>', /COLLADA.*assimp export in\.dae/],
    ["OFF\n3 1 0\n", /an OFF file.*trimesh/],
    ["ISO-10303-21;\n", /a STEP file.*cascadio/],
    ["#usda 1.0\n", /a USD file.*Blender/],
    ["PK\x03\x04 model.usdc", /a USD file.*Blender/],
    ["PK\x03\x04 3D/3dmodel.model", /a 3MF file.*trimesh/],
    ["PK\x03\x04 meta.json means_l.webp", /as SOG.*splat-transform in\.sog out\.ply/],
    ["PK\x03\x04 mesh.glb", /a ZIP archive.*Unpack/],
    ["NGSP\x04", /as SPZ.*splat-transform in\.spz out\.ply/],
    ["\x1f\x8b\x08", /gzip.*splat-transform in\.spz out\.ply/],
    ["Kaydara FBX Binary", /FBX.*Blender/],
    ["BLENDER-v500", /Blender file/],
    ["<!DOCTYPE html>", /an HTML page.*response\.ok/],
    ["version https://git-lfs.github.com/spec/v1\n", /Git LFS.*git lfs pull/],
    [gaussians, /3D Gaussians in a glTF file/],
  ];
  const placed = { scale: 1, rotation: [0, 0, 0, 1], translation: [0, 0, 0] } as const;
  for (const [beginning, found] of files) {
    const bytes = Buffer.from(beginning, "latin1");
    for (const format of [undefined, "glb", "obj"] as const)
      await rejectsWith(() => readMesh(bytes, { format }), "UNSUPPORTED_FORMAT mesh", found);
    await rejectsWith(() => placeSplats(bytes, placed), "UNSUPPORTED_FORMAT splats", found);
  }
  const compressed = Buffer.from("ply\nelement chunk 1\nelement vertex 1\nproperty uint packed_position\nend_header\n");
  await rejectsWith(() => placeSplats(compressed, placed), "UNSUPPORTED_FORMAT splats", /in\.compressed\.ply out\.ply/);
});

test("recordings, and depth in RVL, are named", async () => {
  const rvl = new Uint32Array([0, 0, 0, 64, 48, 0x0001_8000, 7]);
  const files: readonly (readonly [Uint8Array, RegExp])[] = [
    [Buffer.from("\x89MCAP0\r\n", "latin1"), /a recording of ROS/],
    [Buffer.from("#ROSBAG V2.0\n"), /a recording of ROS/],
    [Buffer.from("SQLite format 3\0"), /a recording of ROS/],
    [new Uint8Array(rvl.buffer), /RVL.*compressedDepth/],
  ];
  for (const [bytes, found] of files) await rejectsWith(() => readDepth(bytes), "UNSUPPORTED_FORMAT depth", found);
});

test("a mesh in a folder is read with the files beside it: the texture of a PLY, buffers that a decoder replaces", async () => {
  const rows = ["0 0 0 0 0", "1 0 0 1 0", "0 1 0 0 1"];
  const header = ["ply", "format ascii 1.0", "comment TextureFile t.png", "element vertex 3"];
  const properties = ["x", "y", "z", "texture_u", "texture_v"].map((name) => `property float ${name}`);
  const faces = ["element face 1", "property list uchar int vertex_indices", "end_header"];
  const ply = Buffer.from(`${[...header, ...properties, ...faces, ...rows, "3 0 1 2"].join("\n")}\n`);
  const packed = meshoptGltf(mesh, "EXT_meshopt_compression", false);
  Object.assign(packed.json.buffers[1] ?? {}, { uri: "mesh.fallback.bin" });
  const beside = { "depth.npy": new Uint8Array(), "mask.png": new Uint8Array() };
  const texture = png(Uint8Array.of(200, 30, 60), 1, 1, 3);
  const textured = await readCase({ ...beside, "mesh.ply": ply, "t.png": texture });
  const file = textured.input.mesh as MeshFile;
  const read = await readMesh(file.bytes, { resources: file.resources });
  assert.deepEqual([...(read.samples?.colors.subarray(0, 3) ?? [])], [200, 30, 60]);
  assert.deepEqual(textured.unread, []);
  const { input } = await readCase({ ...beside, "mesh.glb": glbFrom(packed) });
  const { bytes } = input.mesh as MeshFile;
  assert.deepEqual((await readMesh(bytes)).indices.length, mesh.indices.length);
});

const phone: [ExifFields, ExifFields] = [
  { make: "Maker", model: "Phone 1", orientation: 6 },
  { focalLength: { rational: [425, 100] }, focal35: 26, pixelX: 4032, pixelY: 3024, zoom: { rational: [0, 1] } },
];
const reflex: [ExifFields, ExifFields] = [
  { make: "Maker", orientation: 1 },
  {
    ...{ focalLength: { rational: [50, 1] }, planeX: { rational: [6000 * 254, 224] }, planeUnit: 2 },
    ...{ pixelX: 6000, pixelY: 4000, zoom: { rational: [2, 1] } },
  },
];

test("EXIF data of PNG and JPEG, in both byte orders", async () => {
  const shared = { orientation: 6, focalLength35mm: 26, focalLengthMm: 4.25, make: "Maker", model: "Phone 1" };
  for (const isLittle of [true, false]) {
    for (const file of [pngWith(tiff(...phone, isLittle)), jpegHead(tiff(...phone, isLittle))]) {
      assert.deepEqual(await readExif(file), { ...shared, width: 4032, height: 3024 });
    }
    const { sensorWidthMm, ...rest } = await readExif(pngWith(tiff(...reflex, isLittle)));
    assert.ok(Math.abs((sensorWidthMm as number) - 22.4) < 1e-9, `${sensorWidthMm}`);
    const others = { orientation: 1, focalLengthMm: 50, make: "Maker", width: 6000, height: 4000, digitalZoom: 2 };
    assert.deepEqual(rest, others);
  }
  // The photo is turned by the same orientation.
  const { width, height } = await readImage(pngWith(tiff(...phone, true)));
  assert.deepEqual([width, height], [2, 3]);
  assert.deepEqual(await readExif(png(Uint8Array.of(1), 1, 1)), { orientation: 1 });
});

const full: Exif = { orientation: 1, focalLength35mm: 26, width: 4032, height: 3024 };
const sensor: Exif = { orientation: 1, focalLengthMm: 50, sensorWidthMm: 22.4, width: 6000, height: 4000 };
const bySensor = (50 / 22.4) * 6000;
// 43.267 mm, the diagonal of full frame, are 5040 pixels.
const original = (26 * 5040) / 43.2666;
const sure = focalFromExif(full, { width: 4032, height: 3024 })?.uncertainty as number;

/** What is known of the lens, the image, its focal length in pixels, and the range of the uncertainty. */
const focals: [what: string, exif: Exif, width: number, height: number, focalPx: number, low: number, high: number][] =
  [
    ["the equivalent in the original", full, 4032, 3024, original, 0.02, 0.04],
    ["half a millimetre is much of 13", { ...full, focalLength35mm: 13 }, 4032, 3024, original / 2, 1.01 * sure, 0.1],
    ["the sensor's width", sensor, 6000, 4000, bySensor, 0, 0.03],
    ["both contradict each other", { ...sensor, focalLength35mm: 50 }, 6000, 4000, (50 / 36) * 6000, 0.2, 1],
    ["a digital zoom", { ...sensor, digitalZoom: 2 }, 6000, 4000, 2 * bySensor, 0.2, 1],
    ["a quarter of the size", full, 1008, 756, original / 4, 0.999 * sure, 1.001 * sure],
    ["sides that a network likes", full, 518, 392, (original * 518) / 4032, 0, 0.05],
    ["turned by its orientation", { ...full, orientation: 6 }, 756, 1008, original / 4, 0, 0.04],
    ["cropped to a square", full, 3024, 3024, original, 1.001 * sure, 0.05],
    ["smaller on both sides: perhaps resized as well", full, 2400, 2400, original, 2 * sure, 1],
    ["without the original size", { orientation: 1, focalLength35mm: 26 }, 400, 300, (26 * 500) / 43.2666, 0, 1],
  ];

test("the focal length of EXIF data: of the original, resized, turned and cropped, with its uncertainty", () => {
  for (const [what, exif, width, height, focalPx, low, high] of focals) {
    const focal = focalFromExif(exif, { width, height });
    assert.ok(focal !== undefined, what);
    assert.ok(Math.abs(focal.focalPx / focalPx - 1) < 0.01, `${what}: ${focal.focalPx}, ${focalPx}`);
    assert.ok(focal.uncertainty >= low && focal.uncertainty <= high, `${what}: ± ${focal.uncertainty}`);
  }
  assert.match(focalFromExif(full, { width: 4032, height: 3024 })?.source ?? "", /26 mm \(35 mm equivalent\)/);
  assert.match(focalFromExif(full, { width: 3024, height: 3024 })?.source ?? "", /cropped/);
  // Wider than the original: the EXIF data are those of another image.
  assert.equal(focalFromExif(full, { width: 5000, height: 1000 }), undefined);
  assert.equal(focalFromExif({ orientation: 1, width: 40, height: 30 }, { width: 40, height: 30 }), undefined);
  assert.equal(focalFromExif({ ...full, focalLength35mm: 4 }, { width: 4032, height: 3024 }), undefined);
  const wrong = { code: "INVALID_ARGUMENT", argument: "size.width" };
  assert.throws(() => focalFromExif(full, { width: 0, height: 5 }), wrong);
});
