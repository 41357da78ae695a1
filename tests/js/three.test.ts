/** `sim3align/three` with three.js itself. */
import assert from "node:assert/strict";
import { test } from "node:test";
import type { MeshArrays } from "sim3align";
import { toFrame } from "sim3align/conventions";
import {
  applyPinhole,
  applyToObject3D,
  cameraFromPinhole,
  meshInputFromThree,
  transformFromObject3D,
} from "sim3align/three";
import {
  BatchedMesh,
  Bone,
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  Color,
  DataTexture,
  Group,
  InstancedBufferGeometry,
  InstancedMesh,
  InterleavedBuffer,
  InterleavedBufferAttribute,
  LOD,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  MirroredRepeatWrapping,
  type Object3D,
  PerspectiveCamera,
  Quaternion,
  RepeatWrapping,
  Scene,
  Skeleton,
  SkinnedMesh,
  SRGBColorSpace,
  Texture,
  Vector3,
  WebGPUCoordinateSystem,
} from "three";
import { type Refused, rejectsWith } from "../support/errors.js";
import { assertNear, forSeeds, type Random } from "../support/random.js";
import { columnMajor, mesh, transformed, view } from "../support/scene.js";

/** Sets an object's position, rotation and scale at random. */
function place<T extends Group | Mesh | PerspectiveCamera>(object: T, random: Random, isUnit = false): T {
  const { rotation, translation } = random.pose();
  object.quaternion.set(...rotation);
  object.position.set(...translation);
  if (!isUnit) object.scale.setScalar(random.between(0.2, 3));
  return object;
}

function geometryOf(): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(mesh.positions, 3));
  return geometry.setIndex(new BufferAttribute(mesh.indices, 1));
}

test("an object is where the mesh was found: under the camera, and anywhere in a scene", () => {
  forSeeds(20, (random, seed) => {
    const pose = random.pose();
    const below = place(new Group(), random);
    place(new PerspectiveCamera(), random, true).add(below);
    for (const frame of ["opengl", "opencv"] as const) {
      applyToObject3D(below, pose, { frame });
      assertNear(below.matrix.elements, toFrame(pose, frame).matrix, seed);
      assertNear(transformFromObject3D(below, { frame }).matrix, columnMajor(pose), seed);
    }
    const [scene, table] = [new Scene(), place(new Group(), random)];
    const [camera, object] = [place(new PerspectiveCamera(), random, true), place(new Mesh(), random)];
    scene.add(table, place(new Group(), random).add(camera));
    if (random.between(0, 1) < 0.8) table.add(object);
    applyToObject3D(object, pose, { camera });
    scene.updateMatrixWorld(true);
    const point = new Vector3(0.3, -0.7, 0.4);
    const seen = object.localToWorld(point.clone()).applyMatrix4(camera.matrixWorldInverse).toArray();
    const [x = 0, y = 0, z = 0] = transformed(point.toArray(), pose);
    assertNear(seen, [x, -y, -z], seed, 1e-8);
    assertNear(transformFromObject3D(object, { camera }).matrix, columnMajor(pose), seed, 1e-8);
  });
});

test("meshes below an object come in its frame, mirrored and shared ones and instances too", () => {
  forSeeds(10, (random, seed) => {
    const box = new BoxGeometry(1, 2, 3);
    const [root, middle, leaf] = [place(new Group(), random), place(new Group(), random), place(new Mesh(box), random)];
    leaf.scale.set(random.between(0.5, 2), -random.between(0.5, 2), random.between(0.5, 2));
    const moves = [new Matrix4().makeTranslation(1, 2, 3), new Matrix4().makeScale(1, 2, 1)];
    const instances = place(new InstancedMesh(box, undefined, 2), random);
    for (const [i, move] of moves.entries()) instances.setMatrixAt(i, move);
    root.add(middle.add(leaf), instances, new Group());
    place(new Group(), random).add(root).updateMatrixWorld(true);
    const local = root.matrixWorld.clone().invert();
    const placed = [leaf.matrixWorld, ...moves.map((move) => instances.matrixWorld.clone().multiply(move))];
    const corners = Array.from({ length: 24 }, (_, i) =>
      new Vector3().fromBufferAttribute(box.getAttribute("position"), i),
    );
    const expected = placed.flatMap((m) =>
      corners.flatMap((corner) => corner.clone().applyMatrix4(m).applyMatrix4(local).toArray()),
    );
    const found = meshInputFromThree(root);
    assertNear(found.positions, expected, seed, 1e-5);
    const { positions } = meshInputFromThree(root, { frame: "world" });
    assertNear(new Vector3().fromArray(positions).applyMatrix4(local).toArray(), expected.slice(0, 3), seed, 1e-4);
  });
});

test("geometries: as they are, without indices, interleaved, normalised", () => {
  assert.deepEqual(meshInputFromThree(geometryOf()), mesh);
  assert.deepEqual([...meshInputFromThree(geometryOf().toNonIndexed()).indices.subarray(0, 6)], [0, 1, 2, 3, 4, 5]);
  const of = (attribute: BufferAttribute | InterleavedBufferAttribute) =>
    Array.from(meshInputFromThree(new BufferGeometry().setAttribute("position", attribute)).positions);
  const numbers = new InterleavedBuffer(Float32Array.of(9, 0, 0, 0, 9, 1, 0, 0, 9, 0, 1, 0), 4);
  assert.deepEqual(of(new InterleavedBufferAttribute(numbers, 3, 1)), [0, 0, 0, 1, 0, 0, 0, 1, 0]);
  const quantised = Int16Array.of(0, 0, 0, 32767, 0, 0, 0, -32767, 0);
  assert.deepEqual(of(new BufferAttribute(quantised, 3, true)), [0, 0, 0, 1, 0, 0, 0, -1, 0]);
});

test("what three.js draws is read: morph targets, bones, levels, ranges and groups, but nothing that is hidden", async () => {
  const cube = (height = 1) => new BoxGeometry(1, height, 1);
  const count = cube().getAttribute("position").count;
  const stretched = () => {
    const geometry = cube();
    geometry.morphAttributes.position = [cube(3).getAttribute("position") as BufferAttribute];
    const found = new Mesh(geometry);
    found.morphTargetInfluences = [0.5];
    return found;
  };
  const skinned = () => {
    const geometry = cube().setAttribute("skinIndex", new BufferAttribute(new Uint16Array(4 * count), 4));
    const weights = Float32Array.from({ length: 4 * count }, (_, i) => (i % 4 === 0 ? 1 : 0));
    geometry.setAttribute("skinWeight", new BufferAttribute(weights, 4));
    const [bone, found] = [new Bone(), new SkinnedMesh(geometry)];
    const root = new Group().add(bone, found);
    found.bind(new Skeleton([bone]));
    bone.scale.y = 2;
    return root;
  };
  const hidden = (object: Object3D) => Object.assign(object, { visible: false });
  const levels = () => {
    const lod = new LOD().addLevel(new Mesh(cube(2))).addLevel(new Mesh(cube(9)), 5);
    for (const { object } of lod.levels) object.visible = object === lod.levels[1]?.object;
    return lod;
  };
  const ranged = (geometry: BufferGeometry) => {
    // The sides at x = ±1/2, then those at y = ±1/2.
    geometry.setDrawRange(0, 12);
    return new Mesh(geometry);
  };
  const several = new Mesh(
    cube(2),
    [0, 1, 2, 3, 4, 5].map((i) => new MeshBasicMaterial({ visible: i < 2 })),
  );
  const cases: readonly [name: string, object: Object3D, height: number, triangles: number][] = [
    ["morph targets", stretched(), 2, 12],
    ["bones", skinned(), 2, 12],
    ["hidden children", new Group().add(new Mesh(cube(2)), hidden(new Group().add(new Mesh(cube(9))))), 2, 12],
    ["a hidden object that is passed", hidden(new Mesh(cube(2))), 2, 12],
    ["levels", new Group().add(levels()), 2, 12],
    ["a range", ranged(cube(2)), 2, 4],
    ["groups", several, 2, 4],
  ];
  for (const [name, object, height, triangles] of cases) {
    const { positions, indices } = meshInputFromThree(object);
    const y = Array.from(indices, (corner) => positions[3 * corner + 1] as number);
    assert.ok(Math.abs(Math.max(...y) - Math.min(...y) - height) < 1e-6, `${name}: ${Math.max(...y)}`);
    assert.equal(indices.length / 3, triangles, name);
  }
  assert.match(meshInputFromThree(several).warnings?.join() ?? "", /several materials/);
  const material = new MeshStandardMaterial({ color: 0, emissive: new Color(0.5, 0.25, 1) });
  assert.deepEqual([...(meshInputFromThree(new Mesh(cube(), material)).colors?.slice(0, 3) ?? [])], [0.5, 0.25, 1]);
  const unlike: readonly Object3D[] = [
    new Mesh(new InstancedBufferGeometry().setAttribute("position", cube().getAttribute("position"))),
    new Mesh(cube(), new MeshStandardMaterial({ displacementMap: new Texture() })),
    new BatchedMesh(1, 24),
  ];
  for (const object of unlike) await rejectsWith(() => meshInputFromThree(object), "UNSUPPORTED_FORMAT source");
});

test("a pinhole camera in three.js sees every point at its pixel, in WebGL and WebGPU", () => {
  forSeeds(30, (random, seed) => {
    const lens = { width: random.whole(100, 900), height: random.whole(100, 900), near: 0.1, far: 20 };
    const [fx, fy] = random.list(2, 200, 900) as [number, number];
    const pinhole = { fx, fy, cx: random.between(0, lens.width), cy: random.between(0, lens.height) };
    const camera = new PerspectiveCamera(20, 3, 1, 2);
    applyPinhole(camera, pinhole, lens);
    const { projectionMatrix, fov, aspect, near, far } = cameraFromPinhole(pinhole, lens);
    assertNear(projectionMatrix, camera.projectionMatrix.elements, seed);
    assert.deepEqual([fov, aspect, near, far], [camera.fov, camera.aspect, 0.1, 20]);
    for (const system of [camera.coordinateSystem, WebGPUCoordinateSystem]) {
      camera.coordinateSystem = system as typeof camera.coordinateSystem;
      camera.updateProjectionMatrix();
      const [x, y, z] = [random.between(-1, 1), random.between(-1, 1), random.between(0.5, 9)];
      // OpenGL's camera frame, then from clip space to pixels, whose centres are at whole numbers.
      const clip = new Vector3(x, -y, -z).applyMatrix4(camera.projectionMatrix);
      const pixel = [((clip.x + 1) / 2) * lens.width - 0.5, ((1 - clip.y) / 2) * lens.height - 0.5];
      assertNear(pixel, [(fx * x) / z + pinhole.cx, (fy * y) / z + pinhole.cy], `${seed}, ${system}`, 1e-6);
    }
  });
});

test("wrong objects and cameras are refused", async () => {
  const flat = new Group().add(new Mesh(new BoxGeometry()));
  flat.scale.set(1, 0, 1);
  const stretched = new Mesh();
  stretched.scale.set(1, 2, 1);
  const pose = { scale: 1, rotation: new Quaternion().toArray(), translation: [0, 0, 1] };
  const ros = { frame: "ros" as never };
  const refused: Refused[] = [
    [() => meshInputFromThree(new Group()), "EMPTY_MESH source", /no triangle/],
    [() => meshInputFromThree({} as never), "INVALID_ARGUMENT source", /BufferGeometry or an Object3D/],
    [() => meshInputFromThree(flat), "INVALID_TRANSFORM source.matrixWorld", /other than 0/],
    [() => transformFromObject3D(stretched), "INVALID_TRANSFORM transform", /uniform scale/],
    [() => applyToObject3D(new Group(), pose, ros), "INVALID_OPTION options.frame", /"opencv" or "opengl"/],
    [() => cameraFromPinhole(view.camera, { ...view, near: 2, far: 1 }), "INVALID_ARGUMENT lens.far", /beyond near/],
  ];
  for (const each of refused) await rejectsWith(...each);
});

type ColorSamples = NonNullable<MeshArrays["samples"]>;

/** The colour at the sample nearest to a point of the surface. */
function colorNear({ positions, colors }: ColorSamples, point: readonly [number, number, number]): number[] {
  const off = (i: number) => point.reduce((sum, x, axis) => sum + (x - (positions[3 * i + axis] as number)) ** 2, 0);
  let nearest = 0;
  for (let i = 1; i < positions.length / 3; i++) if (off(i) < off(nearest)) nearest = i;
  return [...colors.subarray(3 * nearest, 3 * nearest + 3)];
}

/** A texture of 2 × 2 texels, first row first, and its places on the front of a cube: u grows with x, v with y. */
const texels = [
  [255, 0, 0],
  [0, 255, 0],
  [0, 0, 255],
  [255, 255, 0],
];
const quarters = [
  [-0.25, -0.25, 0.5],
  [0.25, -0.25, 0.5],
  [-0.25, 0.25, 0.5],
  [0.25, 0.25, 0.5],
] as const;

function textureOf(settings: Partial<DataTexture> = {}, offset: [number, number] = [0, 0]): DataTexture {
  const texture = new DataTexture(Uint8Array.from(texels.flatMap((texel) => [...texel, 255])), 2, 2);
  texture.offset.set(...offset);
  return Object.assign(texture, { colorSpace: SRGBColorSpace }, settings);
}

const halfColored = new BoxGeometry();
const count = halfColored.getAttribute("position").count;
halfColored.setAttribute("color", new BufferAttribute(new Float32Array(3 * count).fill(0.5), 3));

test("vertex colours times material colours", () => {
  assert.deepEqual([...(meshInputFromThree(halfColored).colors ?? [])], new Array(3 * count).fill(0.5));
  const white = new Mesh(new BoxGeometry(), new MeshBasicMaterial());
  assert.equal(meshInputFromThree(white).colors, undefined);
  const red = new Color().setRGB(0.5, 0.25, 0);
  const shown = new Mesh(halfColored, new MeshBasicMaterial({ vertexColors: true, color: red }));
  const { colors, colorSpace } = meshInputFromThree(new Group().add(shown, white));
  assert.deepEqual([...(colors?.slice(0, 3) ?? []), colorSpace], [0.25, 0.125, 0, "linear"]);
  assert.deepEqual([...(colors?.slice(-3) ?? []), colors?.length], [1, 1, 1, 6 * count]);
  const hidden = new Mesh(halfColored, new MeshBasicMaterial({ color: red }));
  assert.deepEqual([...(meshInputFromThree(hidden).colors?.slice(0, 3) ?? [])], [0.5, 0.25, 0]);
});

test("textures are sampled on the surface, by their wrapping, channel and the colours that they are multiplied by", () => {
  const seen = (map: Texture, settings: object = {}, box: BufferGeometry = new BoxGeometry()) => {
    const { samples, colors } = meshInputFromThree(new Mesh(box, new MeshBasicMaterial({ map, ...settings })));
    assert.ok(samples && colors === undefined && samples.colors.length === samples.positions.length);
    return quarters.map((point) => colorNear(samples, point));
  };
  const [first, second, third, fourth] = texels;
  // Light of half the strength has the code 188.
  const dim = texels.map((texel) => texel.map((code) => (code === 255 ? 188 : 0)));
  const uv1 = new BoxGeometry();
  uv1.setAttribute("uv1", uv1.getAttribute("uv"));
  uv1.deleteAttribute("uv");
  assert.deepEqual(seen(textureOf()), texels);
  assert.deepEqual(seen(textureOf({ flipY: true })), [third, fourth, first, second]);
  assert.deepEqual(seen(textureOf({ wrapS: RepeatWrapping }, [0.5, 0])), [second, first, fourth, third]);
  assert.deepEqual(seen(textureOf({}, [0.5, 0])), [second, second, fourth, fourth]);
  assert.deepEqual(seen(textureOf({ wrapT: MirroredRepeatWrapping }, [0, 1])), [third, fourth, first, second]);
  const half = { color: new Color().setRGB(0.5, 1, 1) };
  assert.deepEqual(seen(textureOf(), half), [[188, 0, 0], second, third, [188, 255, 0]]);
  assert.deepEqual(seen(textureOf(), { vertexColors: true }, halfColored), dim);
  assert.deepEqual(seen(textureOf({ channel: 1 }), {}, uv1), texels);
});

test("images of browsers are drawn, and turned over as their uploads are", () => {
  const image = { naturalWidth: 2, naturalHeight: 2 };
  const drawn = new Mesh(new BoxGeometry(), new MeshBasicMaterial({ map: new Texture(image as never) }));
  assert.deepEqual([meshInputFromThree(drawn).colors, meshInputFromThree(drawn).samples], [undefined, undefined]);
  const context = { drawImage: () => {}, getImageData: () => textureOf().image };
  Object.assign(globalThis, {
    OffscreenCanvas: function OffscreenCanvas() {
      return { getContext: () => context };
    },
  });
  try {
    assert.deepEqual(colorNear(meshInputFromThree(drawn).samples as ColorSamples, [-0.25, -0.25, 0.5]), texels[2]);
    context.getImageData = () => assert.fail("The canvas has been tainted by cross-origin data.");
    assert.equal(meshInputFromThree(drawn).samples, undefined);
  } finally {
    Reflect.deleteProperty(globalThis, "OffscreenCanvas");
  }
});
