/** Photos and colours of meshes: every form reaches the core as the same bytes, or is an error that names it. */
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { type AlignInput, type ColorSamples, createAligner, type MeshArrays, type PhotoInput } from "sim3align";
import { cropInput } from "sim3align/conventions";
import { externalResources, readCase, readImage, readMesh } from "sim3align/formats";
import { meshInputFromThree } from "sim3align/three";
import {
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  Color,
  DataTexture,
  Group,
  type Material,
  Mesh,
  MeshBasicMaterial,
  MirroredRepeatWrapping,
  RepeatWrapping,
  SRGBColorSpace,
  Texture,
} from "three";
import { folder, pixels, run, writeCase } from "../support/command-line.js";
import { repository } from "../support/environment.js";
import { codesOf, type Fault, rejectsWith } from "../support/errors.js";
import { glb, glbOf, gltfBuffer, gltfJson, npy, obj, png } from "../support/files.js";
import { sourceModule } from "../support/internals.js";
import { withoutTimes } from "../support/results.js";
import { input, mesh, truth, view } from "../support/scene.js";

const { width, height, depth, mask, camera } = view;
const { resolveInput } = await sourceModule("input/resolve.js");
const { fileReaders } = await sourceModule("file-readers.js");
const aligner = await createAligner();

/** What the core gets. */
async function coreInput(changes: object) {
  const { core, warnings } = await resolveInput({ ...input, ...changes }, fileReaders);
  return { ...core, warnings };
}

const fixture = (name: string) => new Uint8Array(readFileSync(join(repository, "tests", "fixtures", name)));
const arrayBuffer = (bytes: Uint8Array) => Uint8Array.from(bytes).buffer;

// A photo whose channels and pixels differ.
const rgb = Uint8Array.from({ length: 3 * width * height }, (_, i) => (7 * i + (i % 3) * 50) % 256);
const rgba = Uint8ClampedArray.from({ length: 4 * width * height }, (_, i) =>
  i % 4 === 3 ? i % 256 : (rgb[3 * Math.floor(i / 4) + (i % 4)] ?? 0),
);

/** Like the class of browsers: its properties are accessors of the prototype. */
class ImageData {
  get data() {
    return rgba;
  }
  get width() {
    return width;
  }
  get height() {
    return height;
  }
  get [Symbol.toStringTag]() {
    return "ImageData";
  }
}

const forms: [name: string, image: () => unknown][] = [
  ["RGB of the depth map's size", () => rgb],
  ["RGBA of the depth map's size", () => rgba],
  ["RGBA in a Uint8Array", () => new Uint8Array(rgba)],
  ["RGB with its size", () => ({ data: rgb, width, height })],
  ["an ImageData", () => new ImageData()],
  ["a view of a larger buffer", () => new Uint8Array([0, ...rgb, 0]).subarray(1, rgb.length + 1)],
];

for (const [name, image] of forms) {
  test(`photo: ${name}`, async () => {
    const plain = image();
    const { image: photo } = await coreInput({
      image: plain instanceof ImageData ? { data: plain.data, width, height } : plain,
    });
    assert.deepEqual(photo, { data: rgb, width, height });
    // Through the whole call, on this thread and in a worker.
    const pooled = await createAligner({ workers: 1 });
    for (const one of [aligner, pooled]) {
      const { metrics } = await one.evaluate({ ...input, image: plain as PhotoInput }, truth);
      assert.ok((metrics.iou ?? 0) > 0.9);
    }
    pooled.dispose();
  });
}

test("photo: files, as bytes, ArrayBuffer and Blob", async () => {
  const file = fixture("photo.png");
  const { data, width, height } = await readImage(file);
  assert.deepEqual([width, height, data.length], [48, 32, 3 * 48 * 32]);
  assert.deepEqual([...data.subarray(0, 3), ...data.subarray(-3)], [200, 40, 30, 220, 200, 40]);
  for (const form of [file, arrayBuffer(file), new Blob([arrayBuffer(file)]), Buffer.from(file)]) {
    assert.deepEqual((await coreInput({ image: form })).image, { data, width, height });
  }
  const jpeg = await readImage(fixture("photo-exif-6.jpg"));
  assert.deepEqual([jpeg.width, jpeg.height], [48, 32]);
  await rejectsWith(() => readImage(Uint8Array.of(1, 2, 3)), "UNSUPPORTED_FORMAT image");
  await rejectsWith(() => readImage(fixture("photo.jpg").slice(0, 300)), "CORRUPT_FILE image");
});

test("photo: large ones are averaged, arrays as files are", async () => {
  const [w, h] = [3001, 1401];
  const pixels = Uint8Array.from({ length: w * h }, (_, i) => ((i % w) * 13 + Math.floor(i / w) * 7) % 256);
  const fromFile = await readImage(png(pixels, w, h));
  const gray = new Uint8Array(3 * w * h);
  for (let i = 0; i < gray.length; i++) gray[i] = pixels[Math.floor(i / 3)] ?? 0;
  const { image } = await coreInput({ image: { data: gray, width: w, height: h } });
  assert.deepEqual([image.width, image.height], [1500, 700]);
  assert.ok(Buffer.from(image.data).equals(Buffer.from(fromFile.data)));
});

test("photo: what is none is named", async () => {
  const wrong: [image: unknown, fault: Fault][] = [
    [7, "INVALID_ARGUMENT image"],
    [new Float32Array(rgb.length), "INVALID_ARGUMENT image"],
    [{ width, height }, "INVALID_ARGUMENT image"],
    [{ data: [...rgb], width, height }, "INVALID_ARGUMENT image.data"],
    [{ data: rgb, width }, "INVALID_ARGUMENT image.height"],
    [{ data: rgb, width: 1.5, height }, "INVALID_ARGUMENT image.width"],
    [{ data: rgb.subarray(3), width, height }, "WRONG_LENGTH image.data"],
    [{ data: new Uint8Array(), width: 0, height: 0 }, "WRONG_LENGTH image.data"],
    [rgba.subarray(4), "WRONG_LENGTH image"],
    [{ data: rgb, width: width * height, height: 1 }, "SIZE_MISMATCH image"],
  ];
  for (const [image, fault] of wrong) {
    await rejectsWith(() => aligner.evaluate({ ...input, image: image as PhotoInput }, truth), fault);
  }
  const detached = Uint8Array.from(rgb);
  structuredClone(detached, { transfer: [detached.buffer] });
  await rejectsWith(() => aligner.evaluate({ ...input, image: detached }, truth), "INVALID_ARGUMENT image");
});

test("photo: hostile files are refused by every call, which works on", async () => {
  const huge = fixture("photo.png");
  // 100 000 × 100 000 pixels.
  huge.set([0, 1, 0x86, 0xa0, 0, 1, 0x86, 0xa0], 16);
  const jpeg = fixture("photo.jpg");
  const frame = jpeg.findIndex((byte, i) => byte === 0xff && jpeg[i + 1] === 0xc0);
  const wide = jpeg.slice();
  wide.fill(0xff, frame + 5, frame + 9);
  const hostile: [image: Uint8Array, fault: Fault][] = [
    [huge, "FILE_TOO_LARGE image"],
    [wide, "FILE_TOO_LARGE image"],
    [jpeg.slice(0, jpeg.length / 2), "CORRUPT_FILE image"],
    [fixture("photo.png").slice(0, -20), "CORRUPT_FILE image"],
    [Buffer.from("RIFF\0\0\0\0WEBPVP8 "), "UNSUPPORTED_FORMAT image"],
  ];
  const before = await aligner.evaluate(input, truth);
  const pooled = await createAligner({ workers: 1 });
  for (const [image, fault] of hostile) {
    await rejectsWith(() => aligner.align({ ...input, image }), fault);
    await rejectsWith(() => pooled.align({ ...input, image }), fault);
    assert.deepEqual(await aligner.evaluate(input, truth), before);
    assert.deepEqual(await pooled.evaluate(input, truth), before);
  }
  pooled.dispose();
});

const vertices = mesh.positions.length / 3;
const colors = Uint8Array.from({ length: 3 * vertices }, (_, i) => (11 * i) % 256);
const withAlpha = Uint8ClampedArray.from({ length: 4 * vertices }, (_, i) =>
  i % 4 === 3 ? 9 : (colors[3 * Math.floor(i / 4) + (i % 4)] ?? 0),
);
const decoded = (code: number) => {
  const x = code / 255;
  return x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4;
};

test("mesh colours: every array form is the same bytes", async () => {
  const same: Partial<MeshArrays>[] = [
    { colors },
    { colors: withAlpha },
    { colors: Float32Array.from(colors, (code) => code / 255) },
    { colors: Float32Array.from(colors, decoded), colorSpace: "linear" },
    { colors: Float32Array.from(withAlpha, decoded), colorSpace: "linear" },
  ];
  for (const form of same) {
    const { mesh: found } = await coreInput({ image: rgb, mesh: { ...mesh, ...form } });
    assert.ok(Buffer.from(found.colors).equals(Buffer.from(colors)));
  }
  const beyond = Float32Array.from({ length: 3 * vertices }, (_, i) => [-1, 2, Number.NaN][i % 3] ?? 0);
  for (const colorSpace of ["srgb", "linear"]) {
    const { mesh: found } = await coreInput({ image: rgb, mesh: { ...mesh, colors: beyond, colorSpace } });
    assert.deepEqual([...found.colors.subarray(0, 3)], [0, 255, 0]);
  }
  // They matter only where there is a photo.
  assert.equal((await coreInput({ mesh: { ...mesh, colors } })).mesh.colors, undefined);
});

test("mesh colours: what is none is named", async () => {
  const samples = { positions: new Float32Array(6), normals: new Float32Array(6), colors: new Uint8Array(6) };
  const wrong: [mesh: object, fault: Fault][] = [
    [{ colors: [...colors] }, "INVALID_ARGUMENT mesh.colors"],
    [{ colors: colors.subarray(3) }, "WRONG_LENGTH mesh.colors"],
    [{ colors, colorSpace: "rgb" }, "INVALID_OPTION mesh.colorSpace"],
    [{ samples: 7 }, "INVALID_ARGUMENT mesh.samples"],
    [{ samples: { ...samples, normals: undefined } }, "INVALID_ARGUMENT mesh.samples.normals"],
    [{ samples: { ...samples, colors: colors.join() } }, "INVALID_ARGUMENT mesh.samples.colors"],
    [{ samples: { ...samples, colors: new Uint8Array(5) } }, "WRONG_LENGTH mesh.samples"],
    [{ samples: { ...samples, positions: new Float32Array(3) } }, "WRONG_LENGTH mesh.samples"],
  ];
  for (const [changes, fault] of wrong) {
    const call = () => aligner.evaluate({ ...input, image: rgb, mesh: { ...mesh, ...changes } as MeshArrays }, truth);
    await rejectsWith(call, fault);
  }
});

test("mesh colours: files bring samples, which can be passed on", async () => {
  const read = await readMesh(fixture("mesh-textured.glb"));
  assert.deepEqual(read.warnings, []);
  assert.equal(read.samples?.colors.length, 3 * 32768);
  assert.equal(read.samples?.positions.length, 3 * 32768);
  const again = await coreInput({ image: rgb, mesh: read });
  assert.deepEqual(again.mesh.samples, read.samples);
  assert.equal((await coreInput({ mesh: read })).mesh.samples, undefined);
  assert.equal((await readMesh(fixture("mesh-textured.glb"), { colors: false })).samples, undefined);
  assert.equal((await readMesh(glb(mesh))).samples, undefined);
  const [ply, colored] = await Promise.all(
    ["mesh-colors.ply", "mesh-colors.glb"].map((name) => readMesh(fixture(name))),
  );
  assert.deepEqual(ply?.samples?.positions, colored?.samples?.positions);
});

/** A textured mesh whose texture is WebP. */
const webp = () => {
  const json = gltfJson(mesh, {}, {}) as ReturnType<typeof gltfJson> & Record<string, unknown>;
  const primitive = json.meshes[0]?.primitives[0] as Record<string, unknown>;
  primitive.attributes = { POSITION: 0, TEXCOORD_0: 2 };
  primitive.material = 0;
  json.accessors.push({ bufferView: 0, componentType: 5126, count: vertices, type: "VEC2" } as never);
  Object.assign(json, {
    materials: [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }],
    textures: [{ source: 0 }],
    images: [{ uri: "data:image/webp;base64,UklGRgAAAABXRUJQVlA4IA==" }],
  });
  return glbOf(json, gltfBuffer(mesh));
};

test("a mesh with a texture that can't be read is aligned by its shape, with a warning where there is a photo", async () => {
  const plain = await aligner.evaluate(input, truth);
  const pooled = await createAligner({ workers: 2 });
  const prepared = await pooled.prepareMesh(webp());
  const withPhoto = { ...input, image: rgb };
  const calls = [
    () => aligner.evaluate({ ...withPhoto, mesh: webp() }, truth),
    () => pooled.evaluate({ ...withPhoto, mesh: webp() }, truth),
    () => pooled.evaluate({ ...withPhoto, mesh: prepared }, truth),
    () => pooled.evaluate({ ...withPhoto, mesh: prepared }, truth),
  ];
  for (const call of calls) {
    const { warnings, ...found } = await call();
    assert.deepEqual(codesOf(warnings), ["COLORS_NOT_READ"]);
    assert.match(warnings[0]?.message ?? "", /WebP.*gltf-transform/);
    assert.deepEqual({ ...found, warnings: plain.warnings }, plain);
  }
  const { mask, mesh: _, ...view } = withPhoto;
  for (const mesh of [webp(), prepared]) {
    const scene = { ...view, objects: [{ mask, mesh }] };
    const [object] = (await pooled.alignScene(scene, { quality: "fast" })).objects;
    assert.ok(object !== undefined && object.error === undefined, object?.error?.message);
    const codes = codesOf(object.warnings);
    assert.ok(codes.includes("COLORS_NOT_READ"), `${codes}`);
  }
  const { warnings } = await aligner.evaluate({ ...input, mesh: webp() }, truth);
  assert.deepEqual(warnings, []);
  pooled.dispose();
});

test("three.js: large textures are averaged, and samples reach the core", async () => {
  const side = 1024;
  const checkered = new Uint8Array(4 * side * side).map((_, i) => (i % 8 < 4 ? 0 : 200));
  const texture = dataTexture({ image: { data: checkered, width: side, height: side } });
  const box = new Mesh(new BoxGeometry(), new MeshBasicMaterial({ map: texture }));
  const { samples } = meshInputFromThree(box);
  assert.ok(samples?.colors.every((code) => code === 100));
  const photo = new Uint8Array(3 * width * height).fill(100);
  const found = await coreInput({ image: photo, mesh: meshInputFromThree(box) });
  assert.deepEqual((found.mesh as MeshArrays).samples, samples);
  const geometry = new BufferGeometry().setIndex(new BufferAttribute(Uint32Array.from(mesh.indices), 1));
  geometry.setAttribute("position", new BufferAttribute(mesh.positions, 3));
  geometry.setAttribute("uv", new BufferAttribute(new Float32Array(2 * vertices), 2));
  const colored = meshInputFromThree(new Mesh(geometry, new MeshBasicMaterial({ map: dataTexture() })));
  const { metrics } = await aligner.evaluate({ ...input, image: photo, mesh: colored }, truth);
  // Neither has any contrast.
  assert.equal(metrics.colorAgreement, 0);
});

test("a photo, or colours, without the other change no bit, with and without workers", async () => {
  const options = { seed: 5, quality: "fast" } as const;
  const plain = withoutTimes(await aligner.align(input, options));
  const pooled = await createAligner({ workers: 2 });
  const prepared = await pooled.prepareMesh({ ...mesh, colors });
  const inputs: AlignInput[] = [
    { ...input, image: rgb },
    { ...input, mesh: { ...mesh, colors } },
    { ...input, mesh: prepared },
  ];
  for (const one of inputs) {
    assert.deepEqual(withoutTimes(await pooled.align(one, options)), plain);
    assert.deepEqual(withoutTimes(await aligner.align(one, options)), plain);
  }
  const both = { ...input, image: rgb, mesh: { ...mesh, colors } };
  const reference = withoutTimes(await aligner.align(both, options));
  assert.deepEqual(withoutTimes(await pooled.align(both, options)), reference);
  assert.deepEqual(withoutTimes(await pooled.align({ ...both, mesh: prepared }, options)), reference);
  for await (const { alignment } of pooled.alignAll([both, { ...both, mesh: prepared }], options)) {
    assert.ok(alignment);
    assert.deepEqual(withoutTimes(alignment), reference);
  }
  const moved = { ...both, image: Uint8Array.from(rgb), mesh: structuredClone(both.mesh) };
  const { input: returned, ...result } = await pooled.align(moved, { ...options, transfer: true });
  assert.deepEqual(withoutTimes(result as never), reference);
  assert.equal(moved.image.length, 0);
  assert.deepEqual([returned?.image, (returned?.mesh as MeshArrays | undefined)?.colors], [rgb, colors]);
  pooled.dispose();
});

test("case folders hold photos, textures and libraries", async () => {
  const files = {
    "depth.npy": npy(depth, height, width),
    "mask.png": png(mask, width, height),
    "camera.json": Buffer.from(JSON.stringify(camera)),
  };
  const photo = fixture("photo.jpg");
  const withPhoto = { ...files, "mesh.glb": glb(mesh), "rgb.jpg": photo };
  const found = await readCase(withPhoto);
  assert.deepEqual([found.input.image, found.files.image], [photo, "rgb.jpg"]);
  const without = await readCase(withPhoto, { image: false });
  assert.deepEqual(["image" in without.input, "image" in without.files], [false, false]);

  const library = Buffer.from("newmtl print\nmap_Kd maps/print.png\n");
  const named = Buffer.concat([Buffer.from("mtllib my.mtl\nmtllib C:\\away.mtl\n"), obj(mesh)]);
  assert.deepEqual(await externalResources(named), { shape: [], colors: ["C:/away.mtl", "my.mtl"] });
  const whole = { ...files, "mesh.obj": named, "my.mtl": library, "maps/print.png": fixture("photo.png") };
  const { mesh: read } = (await readCase(whole)).input as { mesh: { resources: object } };
  assert.deepEqual(Object.keys(read.resources).sort(), ["maps/print.png", "my.mtl"]);
  const { mesh: bare } = (await readCase({ ...files, "mesh.obj": named })).input as { mesh: { resources: object } };
  assert.deepEqual(bare.resources, {});
});

test("three.js: vertex colours times material colours", () => {
  const box = new BoxGeometry();
  const { count } = box.getAttribute("position");
  box.setAttribute("color", new BufferAttribute(new Float32Array(3 * count).fill(0.5), 3));
  assert.deepEqual([...(meshInputFromThree(box).colors ?? [])], new Array(3 * count).fill(0.5));
  const white = new Mesh(new BoxGeometry(), new MeshBasicMaterial());
  assert.equal(meshInputFromThree(white).colors, undefined);
  const red = new Color().setRGB(0.5, 0.25, 0);
  const shown = new Mesh(box, new MeshBasicMaterial({ vertexColors: true, color: red }));
  const { colors: both, colorSpace } = meshInputFromThree(new Group().add(shown, white));
  assert.deepEqual([...(both?.slice(0, 3) ?? []), colorSpace], [0.25, 0.125, 0, "linear"]);
  assert.deepEqual([...(both?.slice(-3) ?? []), both?.length], [1, 1, 1, 6 * count]);
  const hidden = new Mesh(box, new MeshBasicMaterial({ color: red }));
  assert.deepEqual([...(meshInputFromThree(hidden).colors?.slice(0, 3) ?? [])], [0.5, 0.25, 0]);
});

/** The colour at the sample nearest to a point of the surface. */
function colorNear({ positions, colors }: ColorSamples, point: [number, number, number]): number[] {
  const off = (i: number) => point.reduce((sum, x, axis) => sum + (x - (positions[3 * i + axis] as number)) ** 2, 0);
  let nearest = 0;
  for (let i = 1; i < positions.length / 3; i++) if (off(i) < off(nearest)) nearest = i;
  return [...colors.subarray(3 * nearest, 3 * nearest + 3)];
}

/** A texture of 2 × 2 texels, first row first. */
const texels = [
  [255, 0, 0],
  [0, 255, 0],
  [0, 0, 255],
  [255, 255, 0],
] as const;

function dataTexture(settings: Partial<DataTexture> = {}): DataTexture {
  const texture = new DataTexture(Uint8Array.from(texels.flatMap((texel) => [...texel, 255])), 2, 2);
  return Object.assign(texture, { colorSpace: SRGBColorSpace }, settings);
}

test("three.js: textures are sampled on the surface, times the colours of vertices and materials", () => {
  // The quarters of the front of a cube: u grows with x, v with y.
  const quarters: [number, number, number][] = [
    [-0.25, -0.25, 0.5],
    [0.25, -0.25, 0.5],
    [-0.25, 0.25, 0.5],
    [0.25, 0.25, 0.5],
  ];
  const seen = (map: Texture, settings: object = {}, box = new BoxGeometry()) => {
    const mesh = meshInputFromThree(new Mesh(box, new MeshBasicMaterial({ map, ...settings })));
    assert.ok(mesh.samples && mesh.colors === undefined);
    assert.equal(mesh.samples.colors.length, mesh.samples.positions.length);
    return quarters.map((point) => colorNear(mesh.samples as ColorSamples, point));
  };
  const [first, second, third, fourth] = texels.map((texel) => [...texel]) as [number[], number[], number[], number[]];
  assert.deepEqual(seen(dataTexture()), [first, second, third, fourth]);
  assert.deepEqual(seen(dataTexture({ flipY: true })), [third, fourth, first, second]);
  const shifted = dataTexture({ wrapS: RepeatWrapping });
  shifted.offset.set(0.5, 0);
  assert.deepEqual(seen(shifted), [second, first, fourth, third]);
  const clamped = dataTexture();
  clamped.offset.set(0.5, 0);
  assert.deepEqual(seen(clamped), [second, second, fourth, fourth]);
  const mirrored = dataTexture({ wrapT: MirroredRepeatWrapping });
  mirrored.offset.set(0, 1);
  assert.deepEqual(seen(mirrored), [third, fourth, first, second]);
  // Light of half the strength has the code 188.
  const half = { color: new Color().setRGB(0.5, 1, 1) };
  assert.deepEqual(seen(dataTexture(), half), [[188, 0, 0], second, third, [188, 255, 0]]);
  const box = new BoxGeometry();
  const count = box.getAttribute("position").count;
  box.setAttribute("color", new BufferAttribute(new Float32Array(3 * count).fill(0.5), 3));
  const dim = texels.map((texel) => texel.map((code) => (code === 255 ? 188 : 0)));
  assert.deepEqual(seen(dataTexture(), { vertexColors: true }, box), dim);
  const uv1 = new BoxGeometry();
  uv1.setAttribute("uv1", uv1.getAttribute("uv"));
  uv1.deleteAttribute("uv");
  assert.deepEqual(seen(dataTexture({ channel: 1 }), {}, uv1), [first, second, third, fourth]);
});

test("three.js: parts with and without texture, mirrored and moved, keep their own colours", () => {
  const textured = new Mesh(new BoxGeometry(), new MeshBasicMaterial({ map: dataTexture() }));
  textured.position.set(-2, 0, 0);
  textured.scale.set(-1, 1, 1);
  const blue = new Mesh(new BoxGeometry(), new MeshBasicMaterial({ color: new Color().setRGB(0, 0, 1) }));
  const again = new Mesh(textured.geometry, textured.material);
  again.position.set(2, 0, 0);
  const { samples } = meshInputFromThree(new Group().add(textured, blue, again));
  assert.ok(samples);
  assert.deepEqual(colorNear(samples, [-1.75, -0.25, 0.5]), texels[0]);
  assert.deepEqual(colorNear(samples, [0.25, -0.25, 0.5]), [0, 0, 255]);
  assert.deepEqual(colorNear(samples, [1.75, -0.25, 0.5]), texels[0]);
  const { positions, normals } = samples;
  for (let i = 0; i < normals.length / 3; i++) {
    const [x = 0, y = 0, z = 0] = positions.subarray(3 * i, 3 * i + 3);
    const middle = x < -1 ? -2 : x > 1 ? 2 : 0;
    const out = (normals[3 * i] ?? 0) * (x - middle) + (normals[3 * i + 1] ?? 0) * y + (normals[3 * i + 2] ?? 0) * z;
    assert.ok(out > 0.4, `${out} at ${x}, ${y}, ${z}`);
  }
});

test("three.js: images of browsers are drawn, and what cannot be read leaves the mesh without colours", () => {
  const of = (material: Material | Material[]) => meshInputFromThree(new Mesh(new BoxGeometry(), material));
  const none = (material: Material | Material[]) => {
    const { colors, samples } = of(material);
    assert.deepEqual([colors, samples], [undefined, undefined]);
  };
  const image = { naturalWidth: 2, naturalHeight: 2 };
  const drawn = new Texture(image as never);
  none(new MeshBasicMaterial({ map: new Texture() }));
  none(new MeshBasicMaterial({ map: drawn }));
  none([new MeshBasicMaterial({ map: dataTexture() })]);
  const unmapped = new BoxGeometry();
  unmapped.deleteAttribute("uv");
  const { samples } = meshInputFromThree(new Mesh(unmapped, new MeshBasicMaterial({ map: dataTexture() })));
  assert.equal(samples, undefined);

  const calls: unknown[] = [];
  const context = {
    drawImage: (...args: unknown[]) => calls.push(args),
    getImageData: () => dataTexture().image,
  };
  class OffscreenCanvas {
    getContext = () => context;
  }
  Object.assign(globalThis, { OffscreenCanvas });
  try {
    // Elements are turned over when they are uploaded.
    const { samples } = of(new MeshBasicMaterial({ map: drawn }));
    assert.deepEqual(calls, [[image, 0, 0, 2, 2]]);
    assert.deepEqual(colorNear(samples as ColorSamples, [-0.25, -0.25, 0.5]), texels[2]);
    context.getImageData = () => {
      throw new Error("The canvas has been tainted by cross-origin data.");
    };
    none(new MeshBasicMaterial({ map: drawn }));
  } finally {
    Reflect.deleteProperty(globalThis, "OffscreenCanvas");
  }
});

test("cropInput crops the photo with the rest", () => {
  const images = { depth: { data: depth, width, height }, mask: { data: mask, width, height }, camera };
  const box = { left: 3, top: 5, width: 4, height: 2 };
  for (const [data, channels] of [
    [rgb, 3],
    [rgba, 4],
  ] as const) {
    const { image } = cropInput({ ...images, image: { data, width, height } }, box);
    const expected: number[] = [];
    for (const v of [5, 6]) expected.push(...data.subarray(channels * (v * width + 3), channels * (v * width + 7)));
    assert.deepEqual([image.width, image.height, [...image.data]], [4, 2, expected]);
  }
  const other = { ...images, image: { data: new Uint8Array(12), width: 2, height: 2 } };
  assert.throws(() => cropInput(other, box), { code: "SIZE_MISMATCH", argument: "input.image" });
  // Bytes of a file cannot be cropped, and the whole photo would not belong to the part.
  assert.throws(() => cropInput({ ...images, image: fixture("photo.png") as never }, box), { argument: "input.image" });
});

test("command line: --image, --no-image, and the photo of a case folder", () => {
  const name = writeCase("photographed", {
    "depth.npy": npy(depth, height, width),
    "mask.png": pixels,
    "mesh.glb": glb(mesh),
    "camera.json": camera,
  });
  const outcome = (...args: string[]) => {
    const { status, stdout, stderr } = run("align", ...args, "--quality", "fast", "--json", "-");
    const [only] = Object.values(status === 2 ? {} : JSON.parse(stdout)) as { error?: { code: string } }[];
    return [status, only?.error?.code ?? stderr.match(/--image belongs/)?.[0]];
  };
  const files = Object.entries({ depth: "depth.npy", mask: "mask.png", mesh: "mesh.glb", camera: "camera.json" });
  const flags = files.flatMap(([flag, file]) => [`--${flag}`, join(name, file)]);
  const wide = png(new Uint8Array(200), 20, 10);
  writeFileSync(join(folder, "wide.png"), wide);
  assert.deepEqual(outcome(name), [0, undefined]);
  assert.deepEqual(outcome(...flags), [0, undefined]);
  assert.deepEqual(outcome(...flags, "--image", "wide.png"), [1, "SIZE_MISMATCH"]);
  assert.deepEqual(outcome(...flags, "--image", "missing.png"), [1, "FILE_NOT_FOUND"]);
  assert.deepEqual(outcome(name, "--image", "wide.png"), [2, "--image belongs"]);
  writeCase("photographed", { "image.png": wide });
  assert.deepEqual(outcome(name), [1, "SIZE_MISMATCH"]);
  assert.deepEqual(outcome(name, "--no-image"), [0, undefined]);
});
