/** Exported files, read by three.js' loaders and judged by Khronos' validator. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner } from "sim3align";
import {
  applyToPoints,
  exportGlb,
  exportPly,
  exportSceneGlb,
  orientedBoundingBox,
  stretchMesh,
  toFrame,
  toSim3,
} from "sim3align/conventions";
import { PLYLoader } from "three/addons/loaders/PLYLoader.js";
import { type Refused, rejectsWith } from "../support/errors.js";
import { fixture, glbJson, glbOf } from "../support/files.js";
import { assertValid, loadGlb, verticesOf } from "../support/gltf-validator.js";
import { assertNear, Random } from "../support/random.js";
import { input, mesh, truth } from "../support/scene.js";

const soup = { positions: Float32Array.from(mesh.positions.subarray(0, 27)) };
const still = { scale: 1, rotation: [0, 0, 0, 1], translation: [0, 0, 0] } as const;
const aligner = await createAligner();

test("GLB: valid, its vertices in the frame of the camera, by a node or baked, with what is known of the pose", async () => {
  const inOpenGl = toFrame(truth, "opengl");
  for (const mode of ["node", "baked"] as const) {
    for (const frame of ["opengl", "opencv"] as const) {
      const glb = exportGlb(mesh, truth, { mode, frame });
      assert.equal((await assertValid(glb)).totalTriangleCount, mesh.indices.length / 3);
      const pose = frame === "opengl" ? inOpenGl : truth;
      assertNear(await verticesOf(glb), applyToPoints(pose, mesh.positions), `${mode}, ${frame}`, 1e-6);
      const [object] = (await loadGlb(glb)).children;
      assert.deepEqual(object?.userData.sim3align, { frame, metresPerUnit: truth.scale });
      assert.equal(object?.name, "sim3align");
      if (mode === "node") assertNear([object?.scale.x ?? 0], [truth.scale], "the node has the scale");
    }
  }
  await assertValid(exportGlb(soup, truth));
  assertNear(await verticesOf(exportGlb(soup, truth)), applyToPoints(inOpenGl, soup.positions), "soup", 1e-6);
  const triangle = { positions: soup.positions.slice(0, 9), indices: Uint16Array.of(2, 0, 1) };
  const info = await assertValid(exportGlb(triangle, truth, { mode: "baked" }));
  assert.deepEqual([info.totalVertexCount, info.totalTriangleCount], [3, 1]);
});

test("a result's metrics and confidence go into the file, and the aligner reads it", async () => {
  const result = await aligner.align(input, { quality: "fast" });
  assert.deepEqual(toSim3(result).matrix, result.matrix, "to the bit");
  const glb = exportGlb(mesh, result);
  await assertValid(glb);
  const { metrics, confidence } = result;
  const expected = { frame: "opengl", metresPerUnit: result.scale, metrics, confidence };
  assert.deepEqual((await loadGlb(glb)).children[0]?.userData.sim3align, expected);
  // Baked in OpenCV's frame, the mesh is where it should be: no transform is left.
  const baked = exportGlb(mesh, truth, { mode: "baked", frame: "opencv" });
  const found = await aligner.evaluate({ ...input, mesh: baked }, still);
  assert.ok((found.metrics.iou ?? 0) > 0.99, `iou ${found.metrics.iou}`);
});

test("a GLB of another program is put where it is, with all that it has, twice, and without a scene", async () => {
  const binary = (glb: Uint8Array) => glb.subarray(20 + new DataView(glb.buffer, glb.byteOffset).getUint32(12, true));
  for (const name of ["scene.glb", "mesh.glb"]) {
    const original = fixture(name);
    const placed = exportGlb(original, truth, { name: "placed" });
    await assertValid(placed);
    const expected = applyToPoints(toFrame(truth, "opengl"), Float64Array.from(await verticesOf(original)));
    assertNear(await verticesOf(placed), expected, name, 1e-6);
    assert.equal((await loadGlb(placed)).children[0]?.name, "placed");
    assert.deepEqual([...binary(placed)], [...binary(original)], "the binary chunk stays");
    await assertValid(exportGlb(Uint8Array.from(placed).buffer, truth));
  }
  const nodes = [{ children: [1], translation: [1, 2, 3] }, { name: "leaf" }, { name: "other" }];
  const scene = await loadGlb(exportGlb(glbOf({ asset: { version: "2.0" }, nodes }, new Uint8Array()), truth));
  assert.deepEqual([scene.children[0]?.name, scene.children[0]?.children.length], ["sim3align", 2]);
  assert.equal(scene.getObjectByName("leaf")?.parent?.position.y, 2);
  const nothing = glbOf({ asset: { version: "2.0" }, buffers: [{ byteLength: 4 }] }, new Uint8Array(4));
  assert.equal((await loadGlb(exportGlb(nothing, truth))).children.length, 1);
});

test("a scene of several GLB files: morph targets and compressed primitives keep their data", async () => {
  // Two triangles' positions: the first of the base shape, the second of a morph target.
  const data = Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1);
  const accessor = { componentType: 5126, count: 3, type: "VEC3", min: [0, 0, 0], max: [1, 1, 1] };
  const json = {
    ...{ asset: { version: "2.0" }, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }], buffers: [{ byteLength: 72 }] },
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, targets: [{ POSITION: 1 }] }] }],
    accessors: [
      { ...accessor, bufferView: 0, max: [1, 1, 0] },
      { ...accessor, bufferView: 1, min: [0, 0, 1], max: [0, 0, 1] },
    ],
    bufferViews: [0, 36].map((byteOffset) => ({ buffer: 0, byteOffset, byteLength: 36 })),
  };
  const morphing = { mesh: glbOf(json, new Uint8Array(data.buffer)), transform: truth };
  const merged = exportSceneGlb([morphing, morphing]);
  await assertValid(merged);
  const primitivesOf = (glb: Uint8Array) => glbJson(glb).meshes.map((of: { primitives: object[] }) => of.primitives[0]);
  const targets = primitivesOf(merged).flatMap(({ targets }: { targets: object }) => targets);
  assert.deepEqual(targets, [{ POSITION: 1 }, { POSITION: 3 }]);
  const draco = (bufferView: number) => ({ KHR_draco_mesh_compression: { bufferView, attributes: { POSITION: 7 } } });
  const primitives = [{ ...json.meshes[0]?.primitives[0], extensions: draco(1) }];
  const compressed = { mesh: glbOf({ ...json, meshes: [{ primitives }] }, new Uint8Array(72)), transform: truth };
  const [, second] = primitivesOf(exportSceneGlb([compressed, compressed]));
  assert.deepEqual([second.extensions, second.attributes], [draco(3), { POSITION: 2 }]);
});

test("a scene of several GLB files: extensions and further buffers keep what they refer to", () => {
  const uri = `data:application/octet-stream;base64,${Buffer.alloc(36).toString("base64")}`;
  const pointTo = (light: number) => ({ pointer: `/extensions/KHR_lights_punctual/lights/${light}/intensity` });
  const file = {
    ...{ asset: { version: "2.0" }, scenes: [{ nodes: [1] }] },
    extensionsUsed: ["EXT_mesh_gpu_instancing", "EXT_meshopt_compression", "KHR_materials_variants"],
    buffers: [{ byteLength: 36 }, { byteLength: 36, uri }],
    bufferViews: [
      { buffer: 1, byteOffset: 4, byteLength: 24 },
      { buffer: 1, byteLength: 36, extensions: { EXT_meshopt_compression: { buffer: 0, byteLength: 8, count: 3 } } },
    ],
    accessors: [0, 1].map((bufferView) => ({ bufferView, componentType: 5126, count: 2, type: "VEC3" })),
    materials: [{ extensions: { KHR_materials_clearcoat: { clearcoatTexture: { index: 0 }, clearcoatFactor: 1 } } }],
    textures: [{ extensions: { EXT_texture_webp: { source: 0 } }, extras: { source: 0 } }],
    images: [{ bufferView: 1, mimeType: "image/webp" }],
    meshes: [
      {
        primitives: [
          {
            attributes: { POSITION: 1 },
            extensions: { KHR_materials_variants: { mappings: [{ material: 0, variants: [0, 1] }] } },
          },
        ],
      },
    ],
    nodes: [
      { mesh: 0, extensions: { EXT_mesh_gpu_instancing: { attributes: { TRANSLATION: 0 } } } },
      { children: [0], extensions: { KHR_lights_punctual: { light: 0 } } },
    ],
    animations: [
      {
        channels: [{ sampler: 0, target: { path: "pointer", extensions: { KHR_animation_pointer: pointTo(0) } } }],
        samplers: [{ input: 0, output: 1 }],
      },
    ],
    extensions: {
      KHR_lights_punctual: { lights: [{ type: "point" }] },
      KHR_materials_variants: { variants: [{ name: "red" }, { name: "blue" }] },
    },
  };
  const object = { mesh: glbOf(file, new Uint8Array(36)), transform: truth };
  const merged = glbJson(exportSceneGlb([object, object]));
  assert.deepEqual(merged.buffers, [{ byteLength: 72 }, file.buffers[1], file.buffers[1]]);
  const compressed = { buffer: 0, byteOffset: 36, byteLength: 8, count: 3 };
  assert.deepEqual(merged.bufferViews.slice(2), [
    { buffer: 2, byteOffset: 4, byteLength: 24 },
    { buffer: 2, byteOffset: 0, byteLength: 36, extensions: { EXT_meshopt_compression: compressed } },
  ]);
  // The nodes of the first file, then the one that places it.
  assert.deepEqual(merged.nodes.slice(3, 5), [
    { mesh: 1, extensions: { EXT_mesh_gpu_instancing: { attributes: { TRANSLATION: 2 } } } },
    { children: [3], extensions: { KHR_lights_punctual: { light: 1 } } },
  ]);
  const [{ mappings }] = [merged.meshes[1].primitives[0].extensions.KHR_materials_variants];
  assert.deepEqual(mappings, [{ material: 1, variants: [2, 3] }]);
  assert.equal(merged.materials[1].extensions.KHR_materials_clearcoat.clearcoatTexture.index, 1);
  assert.deepEqual(merged.textures[1], { extensions: { EXT_texture_webp: { source: 1 } }, extras: { source: 0 } });
  assert.equal(merged.images[1].bufferView, 3);
  const [channel] = merged.animations[1].channels;
  assert.deepEqual([channel.sampler, channel.target.extensions.KHR_animation_pointer], [0, pointTo(1)]);
  assert.deepEqual(merged.animations[1].samplers, [{ input: 2, output: 3 }]);
  const { KHR_lights_punctual, KHR_materials_variants } = merged.extensions;
  assert.deepEqual([KHR_lights_punctual.lights.length, KHR_materials_variants.variants.length], [2, 4]);
  assert.deepEqual(merged.extensionsUsed, file.extensionsUsed);
  // Extensions with references that are not moved.
  const outlined = { ...file, extensions: { ...file.extensions, EXT_structural_metadata: { propertyTables: [] } } };
  const other = { mesh: glbOf(outlined, new Uint8Array(36)), transform: truth };
  assert.throws(() => exportSceneGlb([object, other]), {
    code: "UNSUPPORTED_FORMAT",
    message: /EXT_structural_metadata/,
  });
  assert.ok(exportSceneGlb([other]).length > 0);
});

test("PLY: three.js reads the vertices and triangles", () => {
  const load = (file: Uint8Array) => new PLYLoader().parse(Uint8Array.from(file).buffer);
  const pose = new Random(1).pose();
  const geometry = load(exportPly(mesh, pose));
  assertNear(geometry.attributes.position?.array ?? [], applyToPoints(pose, mesh.positions), "vertices", 1e-6);
  assert.deepEqual(Array.from(geometry.index?.array ?? []), Array.from(mesh.indices));
  const plain = load(exportPly(soup));
  assert.deepEqual(plain.attributes.position?.array, soup.positions);
  assert.deepEqual(Array.from(plain.index?.array ?? []), [0, 1, 2, 3, 4, 5, 6, 7, 8]);
});

/** A symmetric matrix with positive eigenvalues. */
function stretchOf(random: Random): [number, number, number][] {
  const [a = 0, b = 0, c = 0, d = 0, e = 0, f = 0] = random.list(6, -0.15, 0.15);
  return [
    [1 + a, b, c],
    [b, 1 + d, e],
    [c, e, 1 + f],
  ];
}

test("a mesh and a GLB in other proportions, by nodes that glTF allows", async () => {
  for (let seed = 1; seed <= 5; seed++) {
    const stretch = stretchOf(new Random(seed));
    const by = (row: readonly number[], v: ArrayLike<number>) => row.reduce((sum, s, k) => sum + s * (v[k] ?? 0), 0);
    const expected = Array.from(mesh.positions, (_, i) =>
      by(stretch[i % 3] ?? [], mesh.positions.subarray(i - (i % 3), i - (i % 3) + 3)),
    );
    const { positions } = stretchMesh(mesh, { stretch });
    assertNear(positions, expected, `seed ${seed}`, 1e-6);
    const stretched = stretchMesh(exportGlb(mesh, still, { frame: "opencv" }), { stretch });
    const glb = exportGlb(stretched, truth, { frame: "opencv" });
    await assertValid(glb);
    assertNear(await verticesOf(glb), applyToPoints(truth, positions), `seed ${seed}`, 1e-6);
  }
});

test("what is no mesh, GLB or stretch is refused", async () => {
  const { positions } = soup;
  const glb =
    (wrong: object, options = {}) =>
    () =>
      exportGlb(wrong as never, truth, options);
  const good = Uint8Array.from(exportGlb(soup, truth));
  const place = (at: number, byte: number) => () =>
    exportGlb(
      good.map((old, i) => (i === at ? byte : old)),
      truth,
    );
  const stretch =
    (...numbers: number[]) =>
    () =>
      stretchMesh(mesh, { stretch: numbers } as never);
  const refused: Refused[] = [
    [glb({ positions: [0, 0, 0] }), "INVALID_ARGUMENT mesh.positions", /Float32Array\.from/],
    [glb({ positions: positions.slice(0, 6) }), "WRONG_LENGTH mesh.positions", /2 vertices/],
    [glb({ positions, indices: Uint32Array.of(0, 1, 9) }), "INDEX_OUT_OF_RANGE mesh.indices", /below 9/],
    [glb({ positions: positions.map((x, i) => (i === 5 ? Number.NaN : x)) }), "NON_FINITE mesh.positions", /vertex 1/],
    [glb(soup, { mode: "bake" }), "INVALID_OPTION options.mode", /"node" or "baked"/],
    [() => orientedBoundingBox(good as never, truth), "INVALID_ARGUMENT mesh", /found Uint8Array .*readMesh/],
    [glb({ bytes: good, format: "glb" }), "INVALID_ARGUMENT mesh", /an object with bytes, format.*readMesh.*bytes/],
    [() => exportGlb(new Uint8Array(7), truth), "CORRUPT_FILE glb", /without a GLB header/],
    [() => exportGlb(good, truth, { mode: "baked" }), "INVALID_OPTION options.mode", /"node" keeps/],
    [() => exportGlb(good.slice(0, -1), truth), "CORRUPT_FILE glb", /bytes of/],
    [place(20, 0x78), "CORRUPT_FILE glb", /JSON/],
    [place(4, 1), "UNSUPPORTED_FORMAT glb", /glTF 2/],
    [stretch(1, 0.5, 0, 0, 1, 0, 0, 0, 1), "INVALID_ARGUMENT proportions.stretch", /symmetric/],
    [stretch(1, 0, 0, 0, -1, 0, 0, 0, 1), "INVALID_ARGUMENT proportions.stretch", /positive/],
  ];
  for (const each of refused) await rejectsWith(...each);
});
