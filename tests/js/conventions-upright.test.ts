/** Objects in upright frames of their own, against boxes of known axes. */
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  applyToPoints,
  compose,
  exportGlb,
  exportSceneGlb,
  invert,
  orientedBoundingBox,
  placeGlb,
  toCuboid,
  toSim3,
  uprightGlb,
  uprightMesh,
} from "sim3align/conventions";
import { type BufferGeometry, type Group, Mesh, Quaternion, Vector3 } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { rejectsWith } from "../support/errors.js";
import { assertValid } from "../support/gltf-validator.js";
import { assertNear, forSeeds, type Random } from "../support/random.js";
import { mesh as blob, truth } from "../support/scene.js";

type Triple = [number, number, number];
type Turn = [number, number, number, number];

const turnOf = (random: Random): Turn =>
  new Quaternion(...[0, 1, 2, 3].map(() => random.between(-1, 1))).normalize().toArray() as Turn;

/** A box of these sides about the origin, turned. */
function boxOf(sides: readonly number[], rotation: Turn) {
  const corners = Array.from({ length: 8 }, (_, i) => [i & 1, (i >> 1) & 1, i >> 2]);
  const positions = corners.flatMap((corner) => corner.map((bit, k) => (bit - 0.5) * (sides[k] ?? 0)));
  const faces = [
    [0, 2, 3, 1],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 4, 6, 2],
    [1, 3, 7, 5],
  ] as const;
  const indices = faces.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]);
  const placed = applyToPoints({ scale: 1, rotation, translation: [0.3, -0.2, 0.1] }, Float64Array.from(positions));
  return { positions: Float32Array.from(placed), indices: Uint32Array.from(indices) };
}

/** The extents of vertices along the axes, and their lowest corner. */
function extents(positions: Float32Array): { low: Triple; high: Triple; sides: Triple } {
  const along = [0, 1, 2].map((k) => Array.from(positions).filter((_, i) => i % 3 === k));
  const [low, high] = [along.map((x) => Math.min(...x)), along.map((x) => Math.max(...x))] as [Triple, Triple];
  return { low, high, sides: low.map((x, k) => (high[k] ?? 0) - x) as Triple };
}

const load = async (glb: Uint8Array): Promise<Group> =>
  (await new GLTFLoader().parseAsync(Uint8Array.from(glb).buffer, "")).scene;

function vertices(object: Group): number[] {
  object.updateMatrixWorld(true);
  const found: number[] = [];
  object.traverse((child) => {
    if (!(child instanceof Mesh) || child.name === "support") return;
    const { position } = (child.geometry as BufferGeometry).attributes;
    for (let i = 0; i < (position?.count ?? 0); i++) {
      found.push(
        ...new Vector3()
          .fromBufferAttribute(position as never, i)
          .applyMatrix4(child.matrixWorld)
          .toArray(),
      );
    }
  });
  return found;
}

test("a box that lies askew in its file gets tight axes, its up and its bottom, and stays where it is", () => {
  forSeeds(20, (random) => {
    const sides = [random.between(0.2, 0.4), random.between(0.5, 0.8), random.between(1, 1.5)];
    const mesh = boxOf(sides, turnOf(random));
    const transform = { scale: random.between(0.1, 2), rotation: turnOf(random), translation: [0.1, 0.2, 2] as Triple };
    // The box stands on a side: the normal is one of its axes in the camera frame.
    const own = orientedBoundingBox(mesh, transform, { box: "minimal" });
    const k = random.whole(0, 2);
    const axis = new Vector3(...[0, 1, 2].map((i) => (i === k ? 1 : 0)));
    const normal = axis.applyQuaternion(new Quaternion(...own.rotation)).toArray() as Triple;
    for (const up of ["y", "z"] as const) {
      const straight = uprightMesh(mesh, transform, { support: { normal }, up });
      assertNear(
        applyToPoints(straight.transform, straight.mesh.positions),
        applyToPoints(transform, mesh.positions),
        "vertices in the camera frame",
        1e-5,
      );
      const u = up === "y" ? 1 : 2;
      const upward = new Vector3(...[0, 1, 2].map((i) => (i === u ? 1 : 0)));
      assertNear(upward.applyQuaternion(new Quaternion(...straight.transform.rotation)).toArray(), normal, "up", 1e-6);
      const { low, high, sides: found } = extents(straight.mesh.positions);
      const sorted = (x: readonly number[]) => [...x].sort((a, b) => a - b);
      assertNear(sorted(found), sorted(sides), "sides", 1e-5);
      assertNear([low[u] as number], [0], "the bottom is at the origin", 1e-6);
      for (const i of [0, 1, 2].filter((i) => i !== u))
        assertNear([low[i as 0] + high[i as 0]], [0], "the origin is in the middle", 1e-5);
      const { sizeM } = orientedBoundingBox(straight.mesh, straight.transform);
      assertNear(
        sizeM,
        found.map((side) => side * transform.scale),
        "the box of the upright mesh",
        1e-5,
      );
      assertNear(compose(transform, straight.meshFromUpright).matrix, straight.transform.matrix, "the frame", 1e-9);
    }
  });
});

test("without a support, up is the axis of the box nearest to that of the image", () => {
  forSeeds(10, (random) => {
    const mesh = boxOf([0.3, 0.7, 1.2], turnOf(random));
    const transform = { scale: 1, rotation: turnOf(random), translation: [0, 0, 2] as Triple };
    const straight = uprightMesh(mesh, transform);
    const [, upward] = [0, 1].map((k) =>
      new Vector3(k === 0 ? 1 : 0, k, 0).applyQuaternion(new Quaternion(...straight.transform.rotation)),
    );
    // Of three perpendicular axes, one is within 55° of any direction.
    assert.ok(-(upward?.y ?? 0) > Math.cos((55 * Math.PI) / 180), `${upward?.toArray()}`);
    const { sides } = extents(straight.mesh.positions);
    assertNear([...sides].sort(), [0.3, 0.7, 1.2], "sides", 1e-5);
  });
});

test("what is upright and straight in its file keeps its axes, and what is round its heading", () => {
  const upright = { scale: 0.5, rotation: [1, 0, 0, 0] as Turn, translation: [0, 0, 1] as Triple };
  const box = boxOf([0.4, 0.9, 0.5], [0, 0, 0, 1]);
  assertNear(uprightMesh(box, upright).meshFromUpright.rotation, [0, 0, 0, 1], "a box", 1e-6);
  // A prism of 64 sides that is turned by a quarter of one: some rectangle is smaller, by less than a hundredth.
  const ring = Array.from({ length: 64 }, (_, i) => ((i + 0.25) * Math.PI) / 32);
  const circle = (y: number) => ring.flatMap((a) => [Math.cos(a), y, Math.sin(a)]);
  const positions = Float32Array.from([...circle(0), ...circle(1)]);
  const indices = Uint32Array.from(
    ring.flatMap((_, i) => [i, (i + 1) % 64, 64 + i, (i + 1) % 64, 64 + ((i + 1) % 64), 64 + i]),
  );
  assertNear(
    uprightMesh({ positions, indices }, upright, { support: { normal: [0, -2, 0] } }).meshFromUpright.rotation,
    [0, 0, 0, 1],
    "a prism",
    1e-6,
  );
});

test("a GLB and a scene of upright objects have every vertex where it was", async () => {
  const support = { normal: [0.1, -0.9, -0.4], d: 0.8 };
  const straight = uprightMesh(blob, truth, { support });
  const expected = applyToPoints(truth, blob.positions);
  const identity = { scale: 1, rotation: [0, 0, 0, 1] as Turn, translation: [0, 0, 0] as Triple };
  const file = exportGlb(blob, identity, { frame: "opencv" });
  const glb = uprightGlb(file, blob, truth, { support });
  assertNear(glb.transform.matrix, straight.transform.matrix, "one frame", 0);
  const placed = placeGlb(glb.mesh, glb.transform, { frame: "opencv" });
  await assertValid(placed);
  assertNear(vertices(await load(placed)), expected, "the GLB", 1e-5);
  assertNear(vertices(await load(glb.mesh)), straight.mesh.positions, "in the upright frame", 1e-5);
  const scenes = [
    [{ mesh: blob, transform: truth }],
    [{ mesh: straight.mesh, transform: straight.transform }],
    [{ mesh: glb.mesh, transform: glb.transform }],
  ].map((objects) => exportSceneGlb(objects, { support }));
  // The origin of a scene follows the origins of its meshes along the ground.
  const [own, ...others] = await Promise.all(scenes.map(async (scene) => vertices(await load(scene))));
  for (const other of others) {
    const shift = [0, 1, 2].map((k) => (other[k] ?? 0) - (own?.[k] ?? 0));
    assertNear([shift[1] ?? 1], [0], "heights", 1e-5);
    assertNear(
      other,
      (own ?? []).map((x, i) => x + (shift[i % 3] ?? 0)),
      "the scene",
      1e-5,
    );
  }
  const { tiltRad } = toCuboid(orientedBoundingBox(straight.mesh, straight.transform), { frame: "opencv" });
  const length = Math.hypot(...support.normal);
  assertNear([Math.cos(tiltRad)], [0.9 / length], "the tilt of the cuboid is that of the support", 1e-6);
});

test("samples turn with the mesh", () => {
  const positions = blob.positions.slice(0, 9);
  const samples = { positions, normals: new Float32Array([1, 0, 0, 0, 1, 0, 0, 0, 1]), colors: new Uint8Array(9) };
  const { mesh, meshFromUpright } = uprightMesh({ ...blob, samples }, truth, { support: { normal: [0, -1, 0] } });
  assertNear(applyToPoints(meshFromUpright, mesh.samples?.positions as Float32Array), positions, "positions", 1e-6);
  const turn = { ...toSim3(invert(meshFromUpright)), scale: 1 };
  const { rotation } = turn;
  const expected = applyToPoints({ scale: 1, rotation, translation: [0, 0, 0] }, samples.normals);
  assertNear(mesh.samples?.normals ?? [], expected, "normals", 1e-6);
});

test("what is no plane, axis or mesh is refused", async () => {
  const call = (options: unknown) => () => uprightMesh(blob, truth, options as never);
  await rejectsWith(call({ up: "x" }), "INVALID_OPTION options.up");
  const flat = { support: { normal: [0, 0, 0] } };
  await rejectsWith(call(flat), "INVALID_ARGUMENT the length of options.support.normal");
  await rejectsWith(call({ support: {} }), "INVALID_ARGUMENT options.support.normal");
  await rejectsWith(() => uprightMesh({} as never, truth), "INVALID_ARGUMENT mesh.positions");
});
