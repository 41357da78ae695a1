/** Meshes compressed with meshopt and Draco, read with the decoders of the libraries as they are, and with those of the package. */
import assert from "node:assert/strict";
import { test } from "node:test";
import draco3d from "draco3d";
import { MeshoptDecoder } from "meshoptimizer/decoder";
import { type MeshFromFile, readMesh } from "sim3align/formats";
import { dracoGltf, type Gltf, glbFrom, type Json, meshoptGltf } from "../support/compressed.js";
import { type Fault, rejectsWith } from "../support/errors.js";
import { glb } from "../support/files.js";
import { blob } from "../support/scene.js";

const dracoDecoder = await draco3d.createDecoderModule();
const decoders = { meshoptDecoder: MeshoptDecoder, dracoDecoder };
const mesh = blob(12, 16);
const color = [200, 30, 60] as const;
const exact = () => meshoptGltf(mesh, "EXT_meshopt_compression", false);
const ofDraco = () => dracoGltf(mesh, color);

/** Checks that a mesh has these vertices and triangles; encoders may turn a triangle. */
function assertSame({ positions, indices }: MeshFromFile, tolerance: number): void {
  assert.equal(positions.length, mesh.positions.length);
  for (const [i, x] of mesh.positions.entries()) {
    assert.ok(Math.abs((positions[i] ?? Number.NaN) - x) <= tolerance, `coordinate ${i}: ${positions[i]}, not ${x}`);
  }
  const turned = (all: Uint32Array, i: number) => {
    const corners = [...all.subarray(3 * i, 3 * i + 3)];
    const first = corners.indexOf(Math.min(...corners));
    return [...corners.slice(first), ...corners.slice(0, first)];
  };
  assert.equal(indices.length, mesh.indices.length);
  for (let i = 0; i < indices.length / 3; i++) assert.deepEqual(turned(indices, i), turned(mesh.indices, i));
}

for (const extension of ["EXT_meshopt_compression", "KHR_meshopt_compression"]) {
  test(`${extension} is decoded, of floats without a loss`, async () => {
    assertSame(await readMesh(glbFrom(meshoptGltf(mesh, extension, false)), decoders), 0);
    assertSame(await readMesh(glbFrom(meshoptGltf(mesh, extension, false))), 0);
    const quantised = glbFrom(meshoptGltf(mesh, extension, true));
    assertSame(await readMesh(quantised, { ...decoders, format: "glb" }), 2 / 32767);
  });
}

test("Draco is decoded, with the colours of vertices, for several parts that are the same", async () => {
  const file = ofDraco();
  const [primitive] = file.json.meshes[0]?.primitives ?? [];
  const read = await readMesh(glbFrom(file), decoders);
  assertSame(read, 4 / 2 ** 16);
  assert.deepEqual([read.warnings, [...(read.samples?.colors.subarray(0, 3) ?? [])]], [[], color]);
  file.json.meshes[0]?.primitives.push({ ...(primitive as object), mode: 5 } as never, primitive as never);
  const parts = await readMesh(glbFrom(file), decoders);
  assert.equal(parts.indices.length, 3 * mesh.indices.length);
  assert.deepEqual(await readMesh(glbFrom(file)), parts, "by the decoder of the package");
});

test("compressed data may be in a data URI or in another file", async () => {
  for (const [{ json, buffer }, tolerance] of [
    [exact(), 0],
    [ofDraco(), 4 / 2 ** 16],
  ] as const) {
    const text = (uri: string) => {
      Object.assign(json.buffers[0] ?? {}, { uri });
      return new TextEncoder().encode(JSON.stringify(json));
    };
    const embedded = text(`data:application/octet-stream;base64,${Buffer.from(buffer).toString("base64")}`);
    assertSame(await readMesh(embedded, decoders), tolerance);
    const beside = text("the%20data.bin");
    for (const file of [buffer, Uint8Array.from(buffer).buffer]) {
      assertSame(await readMesh(beside, { ...decoders, resources: { "the data.bin": file } }), tolerance);
    }
    await rejectsWith(() => readMesh(beside, decoders), "INVALID_ARGUMENT options.resources", /the%20data\.bin/);
    await rejectsWith(() => readMesh(text("%"), decoders), "INVALID_ARGUMENT options.resources");
    await rejectsWith(() => readMesh(text("data:;base64,?"), decoders), "INVALID_ARGUMENT options.resources");
  }
});

test("decoders change nothing of files that are not compressed, and damaged files are named by the reader", async () => {
  assert.deepEqual(await readMesh(glb(mesh), decoders), await readMesh(glb(mesh)));
  const whole = glbFrom(exact());
  await rejectsWith(() => readMesh(whole.subarray(0, whole.length - 8), decoders), "CORRUPT_FILE mesh");
  const text = `{"extensionsRequired": ["EXT_meshopt_compression"]`;
  await rejectsWith(() => readMesh(new TextEncoder().encode(text), decoders), "CORRUPT_FILE mesh");
});

type Lie = readonly [name: string, change: (parts: { file: Gltf; view: Json; form: Json }) => void, message: RegExp];

const liesOfMeshopt: readonly Lie[] = [
  ["far more elements than bytes", ({ form }) => Object.assign(form, { count: 2 ** 40 }), /bytes in/],
  ["fewer elements than the view", ({ form }) => Object.assign(form, { count: 5 }), /compressed form/],
  ["a count that is none", ({ form }) => Object.assign(form, { count: -1 }), /"count":-1/],
  ["a stride of 0", ({ form }) => Object.assign(form, { byteStride: 0 }), /"byteStride":0/],
  ["a stride above 256", ({ form }) => Object.assign(form, { byteStride: 260 }), /"byteStride":260/],
  ["another stride than the view", ({ view }) => Object.assign(view, { byteStride: 16 }), /compressed form/],
  ["an unknown mode", ({ form }) => Object.assign(form, { mode: "toString" }), /"mode":"toString"/],
  ["another mode", ({ form }) => Object.assign(form, { mode: "TRIANGLES" }), /"mode":"TRIANGLES"/],
  ["an unknown filter", ({ form }) => Object.assign(form, { filter: "BLUR" }), /"filter":"BLUR"/],
  ["a filter of another stride", ({ form }) => Object.assign(form, { filter: "OCTAHEDRAL" }), /"filter":"OCTAHEDRAL"/],
  ["objects without a text", ({ form }) => Object.assign(form, { mode: { toString: 1 } }), /"mode":{"toString":1}/],
  ["a missing buffer", ({ form }) => Object.assign(form, { buffer: 7 }), /no object 7 of buffers/],
  ["the buffer without data", ({ form }) => Object.assign(form, { buffer: 1 }), /buffer 1 without data/],
  ["bytes outside the buffer", ({ form }) => Object.assign(form, { byteOffset: 1e6 }), /a part of buffer 0/],
  ["no length", ({ form }) => Object.assign(form, { byteLength: null }), /a part of buffer 0/],
  [
    "half of the data",
    ({ form }) => Object.assign(form, { byteLength: 300 }),
    /meshoptDecoder cannot decode: Error: Malf/,
  ],
  ["other data", ({ file }) => file.buffer.fill(7), /meshoptDecoder cannot decode/],
];

const liesOfDraco: readonly Lie[] = [
  ["a missing buffer view", ({ form }) => Object.assign(form, { bufferView: 99 }), /no object 99 of bufferViews/],
  ["bytes outside the buffer", ({ view }) => Object.assign(view, { byteLength: 1e9 }), /a part of buffer 0/],
  ["a third of the data", ({ view }) => Object.assign(view, { byteLength: 300 }), /dracoDecoder cannot decode/],
  ["other data", ({ file }) => file.buffer.fill(7), /dracoDecoder cannot decode: Error: Not a Draco file/],
  [
    "an attribute that it lacks",
    ({ form }) => Object.assign(form, { attributes: { POSITION: 17 } }),
    /POSITION as "VEC3"/,
  ],
  [
    "an attribute of a name",
    ({ form }) => Object.assign(form, { attributes: { POSITION: "0" } }),
    /POSITION as "VEC3"/,
  ],
  ["a missing accessor", ({ form }) => Object.assign(form, { attributes: { TEXCOORD_0: 0 } }), /no object nothing/],
  [
    "more vertices",
    ({ file }) => Object.assign(file.json.accessors[0] ?? {}, { count: 1e9 }),
    /POSITION of 1000000000/,
  ],
  ["more indices", ({ file }) => Object.assign(file.json.accessors[1] ?? {}, { count: 6 }), /indices of 6 elements/],
  [
    "other components",
    ({ file }) => Object.assign(file.json.accessors[0] ?? {}, { type: "VEC2" }),
    /POSITION as "VEC2"/,
  ],
  ["an unknown type", ({ file }) => Object.assign(file.json.accessors[0] ?? {}, { componentType: 5124 }), /of 5124/],
  ["points", ({ file }) => Object.assign(file.json.meshes[0]?.primitives[0] ?? {}, { mode: 0 }), /mode 0/],
];

for (const [format, make, lies] of [
  ["meshopt", exact, liesOfMeshopt],
  ["Draco", ofDraco, liesOfDraco],
] as const) {
  for (const [name, change, message] of lies) {
    test(`${format} with ${name} is refused`, async () => {
      const file = make();
      const [view = {}] = file.json.bufferViews as unknown as Json[];
      const primitive = file.json.meshes[0]?.primitives[0];
      const [form] = Object.values((format === "meshopt" ? view.extensions : (primitive as Json).extensions) as Json);
      change({ file, view, form: form as Json });
      await rejectsWith(() => readMesh(glbFrom(file), decoders), "CORRUPT_FILE mesh", message);
    });
  }
}

test("decoders are usable after files that they refused", async () => {
  assertSame(await readMesh(glbFrom(exact()), decoders), 0);
  assertSame(await readMesh(glbFrom(ofDraco()), decoders), 4 / 2 ** 16);
});

test("many parts of the same data are refused", async () => {
  const [file, draco] = [exact(), ofDraco()];
  file.buffer = new Uint8Array(2 ** 21);
  file.json.buffers[0] = { byteLength: 2 ** 21 };
  const form = { buffer: 0, byteLength: 2 ** 21, byteStride: 4, count: 0, mode: "ATTRIBUTES" };
  const view = { buffer: 1, byteLength: 0, extensions: { EXT_meshopt_compression: form } };
  file.json.bufferViews = Array.from({ length: 600 }, () => view as never);
  // A decoder that would look at each.
  const silent = { ...MeshoptDecoder, decodeGltfBuffer: () => {} };
  await rejectsWith(() => readMesh(glbFrom(file), { meshoptDecoder: silent }), "CORRUPT_FILE mesh", /overlap/);
  const compressed = { bufferView: 0, attributes: {} };
  draco.json.bufferViews[0] = { buffer: 0, byteOffset: 0, byteLength: draco.buffer.length };
  const primitives = Array.from({ length: 20_000 }, (_, i) => ({
    attributes: { _N: i },
    extensions: { KHR_draco_mesh_compression: compressed },
  }));
  draco.json.meshes = [{ primitives: primitives as never }];
  await rejectsWith(() => readMesh(glbFrom(draco), decoders), "CORRUPT_FILE mesh", /overlap/);
});

test("more than a gibibyte is refused before it is allocated", async () => {
  const file = exact();
  const form = {
    buffer: 0,
    byteOffset: 0,
    byteLength: 2 ** 21,
    byteStride: 256,
    count: 2 ** 22 + 256,
    mode: "ATTRIBUTES",
  };
  file.json.bufferViews[0] = { buffer: 1, byteLength: 12, extensions: { EXT_meshopt_compression: form } } as never;
  file.json.buffers[0] = { byteLength: 2 ** 21 };
  file.buffer = new Uint8Array(2 ** 21);
  await rejectsWith(() => readMesh(glbFrom(file), decoders), "FILE_TOO_LARGE mesh");
  const many = { num_points: () => 2 ** 29, num_faces: () => 1, num_attributes: () => 1, ptr: 8 };
  const status = { ok: () => true, error_msg: () => "" };
  const lying = {
    ...dracoDecoder,
    ...{ Mesh: Object.assign(function Mesh() {}), destroy: () => {}, _malloc: () => assert.fail("allocated") },
    Decoder: class {
      DecodeBufferToMesh = (_: object, mesh: object) => Object.assign(mesh, many) && status;
      GetAttributeByUniqueId = () => ({ num_components: () => 3 });
      GetTrianglesUInt32Array() {}
      GetAttributeDataArrayForAllPoints() {}
    },
  };
  const draco = ofDraco();
  Object.assign(draco.json.accessors[0] ?? {}, { count: 2 ** 29 });
  Object.assign(draco.json.accessors[1] ?? {}, { count: 3 });
  await rejectsWith(() => readMesh(glbFrom(draco), { dracoDecoder: lying }), "FILE_TOO_LARGE mesh");
});

test("decoders that are none, cannot start, or throw, are named", async () => {
  const meshopt = (change: object) => ({ meshoptDecoder: { ...MeshoptDecoder, ...change } });
  const throwing = () => {
    throw new Error("no luck");
  };
  const noDraco = draco3d.createDecoderModule();
  const broken: readonly (readonly [options: object, fault: Fault, message: RegExp])[] = [
    [{ meshoptDecoder: {} }, "INVALID_ARGUMENT options.meshoptDecoder", /no decoder/],
    [meshopt({ supported: false }), "INVALID_ARGUMENT options.meshoptDecoder", /not supported here/],
    [meshopt({ ready: Promise.reject(new Error("no luck")) }), "INVALID_ARGUMENT options.meshoptDecoder", /no luck/],
    [meshopt({ decodeGltfBuffer: throwing }), "CORRUPT_FILE mesh", /meshoptDecoder cannot decode: Error: no luck/],
    [{ dracoDecoder: noDraco }, "INVALID_ARGUMENT options.dracoDecoder", /createDecoderModule/],
    [{ dracoDecoder: draco3d }, "INVALID_ARGUMENT options.dracoDecoder", /createDecoderModule/],
    [{ dracoDecoder: { ...dracoDecoder, Mesh: throwing } }, "CORRUPT_FILE mesh", /dracoDecoder cannot decode/],
    [{ dracoDecoder: { ...dracoDecoder, _malloc: () => 0 } }, "CORRUPT_FILE mesh", /memory is exhausted/],
    [{ dracoDecoder: { ...dracoDecoder, _malloc: () => 2 ** 40 } }, "CORRUPT_FILE mesh", /dracoDecoder cannot decode/],
  ];
  for (const [options, fault, message] of broken) {
    const file = glbFrom("dracoDecoder" in options ? ofDraco() : exact());
    await rejectsWith(() => readMesh(file, options), fault, message);
  }
  const getter = Object.defineProperty({}, "dracoDecoder", { enumerable: true, get: throwing });
  await rejectsWith(() => readMesh(glbFrom(ofDraco()), getter), "INVALID_ARGUMENT options.dracoDecoder", /no luck/);
});
