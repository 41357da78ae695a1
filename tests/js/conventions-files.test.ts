/** Exported files, read by three.js' loaders and judged by Khronos' validator. */
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { createAligner } from "sim3align";
import {
  applyToPoints,
  exportGlb,
  exportPly,
  exportSceneGlb,
  orientedBoundingBox,
  placeGlb,
  stretchGlb,
  stretchMesh,
  toFrame,
  toSim3,
} from "sim3align/conventions";
import { type BufferGeometry, type Group, Mesh, Vector3 } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { PLYLoader } from "three/addons/loaders/PLYLoader.js";
import { repository } from "../support/environment.js";
import { type Fault, rejectsWith } from "../support/errors.js";
import { glbJson, glbOf } from "../support/files.js";
import { assertValid } from "../support/gltf-validator.js";
import { assertNear, forSeeds, Random } from "../support/random.js";
import { mesh, truth, view } from "../support/scene.js";

const buffer = (bytes: Uint8Array) => Uint8Array.from(bytes).buffer;
const load = async (glb: Uint8Array): Promise<Group> => (await new GLTFLoader().parseAsync(buffer(glb), "")).scene;
const soup = { positions: Float32Array.from(mesh.positions.subarray(0, 27)) };

interface Primitive {
  targets: object[];
}

/** All vertices below an object, where the scene has them. */
function vertices(object: Group): number[] {
  object.updateMatrixWorld(true);
  const found: number[] = [];
  object.traverse((child) => {
    if (!(child instanceof Mesh)) return;
    const { position } = (child.geometry as BufferGeometry).attributes;
    for (let i = 0; i < (position?.count ?? 0); i++) {
      const vertex = new Vector3().fromBufferAttribute(position as never, i).applyMatrix4(child.matrixWorld);
      found.push(...vertex.toArray());
    }
  });
  return found;
}

for (const mode of ["node", "baked"] as const) {
  for (const frame of ["opengl", "opencv"] as const) {
    test(`GLB, ${mode}, ${frame}: valid, and its vertices are in the camera's frame`, async () => {
      const glb = exportGlb(mesh, truth, { mode, frame });
      const info = await assertValid(glb);
      assert.equal(info.totalTriangleCount, mesh.indices.length / 3);
      const pose = frame === "opengl" ? toFrame(truth, "opengl") : truth;
      const scene = await load(glb);
      assertNear(vertices(scene), applyToPoints(pose, mesh.positions), mode, 1e-6);
      const [object] = scene.children;
      assert.equal(object?.name, "sim3align");
      assert.deepEqual(object?.userData.sim3align, { frame, metresPerUnit: truth.scale });
      if (mode === "node") assertNear([object?.scale.x ?? 0], [truth.scale], "the node has the scale");
    });
  }
}

test("GLB: meshes without indices, with 16-bit indices, and with one triangle", async () => {
  await assertValid(exportGlb(soup, truth));
  assertNear(
    vertices(await load(exportGlb(soup, truth))),
    applyToPoints(toFrame(truth, "opengl"), soup.positions),
    "soup",
    1e-6,
  );
  const [triangle, indices] = [soup.positions.slice(0, 9), Uint16Array.of(2, 0, 1)];
  const info = await assertValid(exportGlb({ positions: triangle, indices }, truth, { mode: "baked" }));
  assert.deepEqual([info.totalVertexCount, info.totalTriangleCount], [3, 1]);
});

test("a result's metrics and confidence go into the file, and the aligner reads it", async () => {
  const aligner = await createAligner();
  const { width, height, depth, mask, camera } = view;
  const input = { depth, width, height, mask, camera };
  const result = await aligner.align({ ...input, mesh });
  assert.deepEqual(toSim3(result).matrix, result.matrix, "to the bit");
  const glb = exportGlb(mesh, result);
  await assertValid(glb);
  const { userData } = (await load(glb)).children[0] ?? {};
  assert.deepEqual(userData?.sim3align, {
    frame: "opengl",
    metresPerUnit: result.scale,
    metrics: result.metrics,
    confidence: result.confidence,
  });
  // Baked in OpenCV's frame, the mesh is where it should be: no transform is left.
  const identity = toSim3({ scale: 1, rotation: [0, 0, 0, 1], translation: [0, 0, 0] });
  const baked = exportGlb(mesh, truth, { mode: "baked", frame: "opencv" });
  const { metrics } = await aligner.evaluate({ ...input, mesh: baked }, identity);
  assert.ok((metrics.iou ?? 0) > 0.99, `iou ${metrics.iou}`);
});

for (const name of ["scene.glb", "mesh.glb"]) {
  test(`${name} is put where it is, with all that it has`, async () => {
    const original = readFileSync(join(repository, "tests", "fixtures", name));
    const expected = applyToPoints(toFrame(truth, "opengl"), Float64Array.from(vertices(await load(original))));
    const placed = placeGlb(original, truth, { name: "placed" });
    await assertValid(placed);
    assertNear(vertices(await load(placed)), expected, name, 1e-6);
    assert.equal((await load(placed)).children[0]?.name, "placed");
    const binary = (glb: Uint8Array) => glb.subarray(20 + new DataView(glb.buffer, glb.byteOffset).getUint32(12, true));
    assert.deepEqual([...binary(placed)], [...binary(original)], "the binary chunk stays");
    // And again: the transforms go one after the other.
    await assertValid(placeGlb(buffer(placed), truth));
  });
}

test("a GLB without a scene, and one with nothing in it, can be placed", async () => {
  const nodes = [{ children: [1], translation: [1, 2, 3] }, { name: "leaf" }, { name: "other" }];
  const placed = placeGlb(glbOf({ asset: { version: "2.0" }, nodes }, new Uint8Array()), truth);
  const scene = await load(placed);
  assert.deepEqual(
    scene.children.map(({ name }) => name),
    ["sim3align"],
  );
  assert.equal(scene.getObjectByName("leaf")?.parent?.position.y, 2);
  assert.equal(scene.children[0]?.children.length, 2);
  const nothing = glbOf({ asset: { version: "2.0" }, buffers: [{ byteLength: 4 }] }, new Uint8Array(4));
  assert.equal((await load(placeGlb(nothing, truth))).children.length, 1);
});

test("a scene of several GLB files: morph targets and compressed primitives keep their data", async () => {
  // Two triangles' positions: the first of the base shape, the second of a morph target.
  const data = Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1);
  const accessor = { componentType: 5126, count: 3, type: "VEC3", min: [0, 0, 0], max: [1, 1, 1] };
  const json = {
    asset: { version: "2.0" },
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, targets: [{ POSITION: 1 }] }] }],
    accessors: [
      { ...accessor, bufferView: 0, max: [1, 1, 0] },
      { ...accessor, bufferView: 1, min: [0, 0, 1], max: [0, 0, 1] },
    ],
    bufferViews: [0, 36].map((byteOffset) => ({ buffer: 0, byteOffset, byteLength: 36 })),
    buffers: [{ byteLength: 72 }],
  };
  const morphing = { mesh: glbOf(json, new Uint8Array(data.buffer)), transform: truth };
  const merged = exportSceneGlb([morphing, morphing]);
  await assertValid(merged);
  const targets = (glb: Uint8Array) =>
    glbJson(glb).meshes.map(({ primitives: [primitive] }: { primitives: Primitive[] }) => primitive?.targets);
  assert.deepEqual(targets(merged), [[{ POSITION: 1 }], [{ POSITION: 3 }]]);

  const draco = { bufferView: 1, attributes: { POSITION: 7 } };
  const [primitive] = json.meshes[0]?.primitives ?? [];
  const primitives = [{ ...primitive, extensions: { KHR_draco_mesh_compression: draco } }];
  const compressed = { mesh: glbOf({ ...json, meshes: [{ primitives }] }, new Uint8Array(72)), transform: truth };
  const [, second] = glbJson(exportSceneGlb([compressed, compressed])).meshes;
  const moved = { bufferView: 3, attributes: { POSITION: 7 } };
  assert.deepEqual(second.primitives[0].extensions, { KHR_draco_mesh_compression: moved });
  assert.deepEqual(second.primitives[0].attributes, { POSITION: 2 });
});

test("PLY: three.js reads the vertices and triangles", () => {
  forSeeds(3, (random, seed) => {
    const pose = random.pose();
    const file = exportPly(mesh, pose);
    const header = Buffer.from(file).indexOf("end_header\n") + 11;
    assert.equal(file.length, header + 4 * mesh.positions.length + (13 * mesh.indices.length) / 3, seed);
    const geometry = new PLYLoader().parse(buffer(file));
    assertNear(geometry.attributes.position?.array ?? [], applyToPoints(pose, mesh.positions), seed, 1e-6);
    assert.deepEqual(Array.from(geometry.index?.array ?? []), Array.from(mesh.indices), seed);
  });
  const plain = new PLYLoader().parse(buffer(exportPly(soup)));
  assert.deepEqual(plain.attributes.position?.array, soup.positions);
  assert.deepEqual(Array.from(plain.index?.array ?? []), [0, 1, 2, 3, 4, 5, 6, 7, 8]);
});

test("what is no mesh is refused", async () => {
  const { positions } = soup;
  const cases: [unknown, Fault, RegExp][] = [
    [{ positions: [0, 0, 0] }, "INVALID_ARGUMENT mesh.positions", /Float32Array\.from/],
    [{ positions: positions.slice(0, 8) }, "WRONG_LENGTH mesh.positions", /8 numbers/],
    [{ positions: positions.slice(0, 6) }, "WRONG_LENGTH mesh.positions", /2 vertices/],
    [{ positions: new Float32Array() }, "EMPTY_MESH mesh", /no vertex/],
    [{ positions, indices: new Uint32Array() }, "EMPTY_MESH mesh", /no triangle/],
    [{ positions, indices: Uint32Array.of(0, 1, 9) }, "INDEX_OUT_OF_RANGE mesh.indices", /below 9/],
    [{ positions, indices: Uint32Array.of(0, 1) }, "WRONG_LENGTH mesh.indices", /2 indices/],
    [
      { positions: positions.map((x, i) => (i === 5 ? Number.NaN : x)) },
      "NON_FINITE mesh.positions",
      /NaN in vertex 1/,
    ],
  ];
  for (const [wrong, ...expected] of cases) await rejectsWith(() => exportGlb(wrong as never, truth), ...expected);
  await rejectsWith(
    () => exportGlb(soup, truth, { mode: "bake" as never }),
    "INVALID_OPTION options.mode",
    /"node" or "baked"/,
  );
});

test("what is no GLB is refused, whatever its bytes", async () => {
  const good = Uint8Array.from(exportGlb(soup, truth));
  await rejectsWith(() => placeGlb(new Uint8Array(7), truth), "CORRUPT_FILE glb", /without a GLB header/);
  await rejectsWith(() => placeGlb(good.slice(0, -1), truth), "CORRUPT_FILE glb", /bytes of/);
  const broken = good.slice();
  broken[20] = 0x78;
  await rejectsWith(() => placeGlb(broken, truth), "CORRUPT_FILE glb", /JSON/);
  const long = good.slice();
  long[15] = 0x7f;
  await rejectsWith(() => placeGlb(long, truth), "CORRUPT_FILE glb", /a chunk up to/);
  await rejectsWith(() => placeGlb("glb" as never, truth), "INVALID_ARGUMENT glb", /bytes of a GLB/);
  const old = good.slice();
  old[4] = 1;
  await rejectsWith(() => placeGlb(old, truth), "UNSUPPORTED_FORMAT glb", /glTF 2/);
  // Bytes changed at random are placed or refused, never anything else.
  const random = new Random(5);
  for (let i = 0; i < 300; i++) {
    const changed = good.slice();
    changed[random.whole(0, 200)] = random.whole(0, 255);
    try {
      placeGlb(changed, truth);
    } catch (error) {
      assert.equal((error as Error).name, "Sim3AlignError", `change ${i}: ${error}`);
    }
  }
});

/** A symmetric matrix with positive eigenvalues. */
function stretchOf(random: Random): [number, number, number][] {
  const [a, b, c, d, e, f] = Array.from({ length: 6 }, () => random.between(-0.15, 0.15)) as [
    number,
    number,
    number,
    number,
    number,
    number,
  ];
  return [
    [1 + a, b, c],
    [b, 1 + d, e],
    [c, e, 1 + f],
  ];
}

test("a GLB in other proportions is the mesh in them, by nodes that glTF allows", async () => {
  const original = exportGlb(mesh, truth);
  for (let seed = 1; seed <= 5; seed++) {
    const stretch = stretchOf(new Random(seed));
    const expected = Array.from(mesh.positions, (_, i) => {
      const row = stretch[i % 3] as [number, number, number];
      const first = i - (i % 3);
      return row.reduce((sum, s, k) => sum + s * (mesh.positions[first + k] as number), 0);
    });
    const { positions } = stretchMesh(mesh, { stretch });
    assertNear(positions, expected, `seed ${seed}`, 1e-6);
    const glb = placeGlb(
      stretchGlb(exportGlb(mesh, { scale: 1, rotation: [0, 0, 0, 1], translation: [0, 0, 0] }, { frame: "opencv" }), {
        stretch,
      }),
      truth,
      { frame: "opencv" },
    );
    await assertValid(glb);
    assertNear(vertices(await load(glb)), applyToPoints(truth, positions), `seed ${seed}`, 1e-6);
  }
  assert.notDeepEqual(stretchGlb(original, { stretch: [1.1, 0, 0, 0, 1, 0, 0, 0, 1] }), original);
});

test("normals of a stretched surface stay perpendicular to it", () => {
  const [points, normals] = [new Float32Array([0, 0, 1, 1, 0, 0]), new Float32Array([0, 0.6, 0.8, 0, 0.6, 0.8])];
  const samples = { positions: points, normals, colors: new Uint8Array(6) };
  for (let seed = 1; seed <= 5; seed++) {
    const stretch = stretchOf(new Random(seed));
    const { samples: found } = stretchMesh({ ...soup, samples }, { stretch });
    const n = found?.normals.subarray(0, 3) ?? [];
    // Two directions of the plane of the normal.
    for (const along of [
      [1, 0, 0],
      [0, 0.8, -0.6],
    ]) {
      const moved = stretch.map((row) => row.reduce((sum, s, k) => sum + s * (along[k] ?? 0), 0));
      assert.ok(Math.abs(moved.reduce((sum, x, k) => sum + x * (n[k] ?? 0), 0)) < 1e-6);
    }
    assert.ok(Math.abs(Math.hypot(...n) - 1) < 1e-6);
  }
});

test("what is no stretch is refused", async () => {
  const bad: [unknown, RegExp][] = [
    [{ stretch: [1, 0.5, 0, 0, 1, 0, 0, 0, 1] }, /symmetric/],
    [{ stretch: [1, 0, 0, 0, -1, 0, 0, 0, 1] }, /positive/],
    [{ stretch: [1, 2] }, /nine/],
    [undefined, /proportions/],
  ];
  for (const [proportions, message] of bad) {
    await assert.rejects(async () => stretchMesh(mesh, proportions as never), message);
  }
});

test("an object is measured in the proportions that align found", async () => {
  const aligner = await createAligner();
  const narrow = { ...mesh, positions: mesh.positions.map((x, i) => (i % 3 === 0 ? 0.9 * x : x)) };
  const input = { ...view, mesh: narrow };
  const plain = await aligner.align(input, { quality: "fast" });
  const found = await aligner.align(input, { quality: "fast", proportions: "axes" });
  assert.deepEqual(found.matrix, plain.matrix);
  assert.equal(plain.proportions, undefined);
  const { proportions } = found;
  assert.ok(proportions !== undefined);
  const ratio = ([x, y]: readonly number[]) => (x as number) / (y as number);
  const truthRatio = ratio(orientedBoundingBox(mesh, truth).sizeM);
  const before = ratio(orientedBoundingBox(narrow, found).sizeM);
  const after = ratio(orientedBoundingBox(stretchMesh(narrow, proportions), proportions).sizeM);
  assert.ok(
    Math.abs(Math.log(after / truthRatio)) < 0.5 * Math.abs(Math.log(before / truthRatio)),
    `${after}, ${before}, ${truthRatio}`,
  );
  assert.equal(
    (await aligner.align(input, { quality: "fast", proportions: "full", scale: 0.09 })).proportions,
    undefined,
  );
});
