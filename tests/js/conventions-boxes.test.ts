/** Real dimensions, cuboids and upright frames, against boxes that were built to size. */
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  applyToPoints,
  compose,
  exportGlb,
  exportSceneGlb,
  fromCvatCuboid,
  fromFrame,
  orientedBoundingBox,
  toCuboid,
  toCvatCuboid,
  toFrame,
  uprightMesh,
} from "sim3align/conventions";
import { Euler, Matrix4, Quaternion, Vector3 } from "three";
import { type Refused, rejectsWith } from "../support/errors.js";
import { assertValid, verticesOf } from "../support/gltf-validator.js";
import { assertNear, forSeeds, type Random } from "../support/random.js";
import { cuboid, type Mesh, mesh, type Pose, truth } from "../support/scene.js";

type Triple = [number, number, number];
type Turn = [number, number, number, number];

const still: Pose = { scale: 1, rotation: [0, 0, 0, 1], translation: [0, 0, 0] };
const turnOf = (random: Random): Turn =>
  new Quaternion(...(random.list(4, -1, 1) as Turn)).normalize().toArray() as Turn;

/** A box of these sides, turned and moved in the mesh's own frame. */
function boxOf(sides: readonly number[], pose: Pose): Mesh {
  const [x = 0, y = 0, z = 0] = sides.map((side) => side / 2);
  const { positions, indices } = cuboid(x, y, z);
  return { positions: Float32Array.from(applyToPoints(pose, Float64Array.from(positions))), indices };
}

/** The lowest and the highest corner of points. */
function bounds(points: ArrayLike<number>): { low: Triple; high: Triple; sides: Triple } {
  const along = [0, 1, 2].map((k) => Array.from(points).filter((_, i) => i % 3 === k));
  const [low, high] = [along.map((x) => Math.min(...x)), along.map((x) => Math.max(...x))] as [Triple, Triple];
  return { low, high, sides: low.map((x, k) => (high[k] ?? 0) - x) as Triple };
}

const sorted = (numbers: readonly number[]) => [...numbers].sort((a, b) => a - b);

test("the box along the mesh's axes has its extents, scaled; its parts agree", () => {
  const box = orientedBoundingBox(mesh, truth);
  const sizes = bounds(mesh.positions).sides.map((side) => truth.scale * side);
  assertNear(box.sizeM, sizes, "size");
  assert.ok(new Quaternion(...box.rotation).angleTo(new Quaternion(...truth.rotation)) < 1e-6);
  const pose = new Matrix4().compose(
    new Vector3(...box.centerM),
    new Quaternion(...box.rotation),
    new Vector3(1, 1, 1),
  );
  const inBox = (point: number[]) => new Vector3().fromArray(point).applyMatrix4(pose.clone().invert()).toArray();
  for (const [i, corner] of box.corners.entries()) {
    const expected = [i & 1, (i >> 1) & 1, i >> 2].map((bit, k) => (bit - 0.5) * (box.sizeM[k as 0] ?? 0));
    assertNear(inBox(corner), expected, `corner ${i}`, 1e-6);
  }
});

test("the smallest box around a turned box is that box", () => {
  forSeeds(20, (random, seed) => {
    const sides = random.list(3, 0.2, 2);
    const [inside, pose] = [{ ...random.pose(), scale: 1 }, random.pose()];
    const box = orientedBoundingBox(boxOf(sides, inside), pose, { box: "minimal" });
    assertNear(sorted(box.sizeM), sorted(sides.map((side) => side * pose.scale)), seed, 1e-5);
    assertNear(box.centerM, applyToPoints(pose, Float64Array.from(inside.translation)), seed, 1e-5);
  });
  const upright = boxOf([0.3, 2, 1], { ...still, translation: [0.1, 0.2, 0.3] });
  const [plain, minimal] = [
    orientedBoundingBox(upright, truth),
    orientedBoundingBox(upright, truth, { box: "minimal" }),
  ];
  assertNear([...minimal.sizeM, ...minimal.rotation], [...plain.sizeM, ...plain.rotation], "axes keep their names");
  const flat = { positions: Float32Array.of(0, 0, 0, 1, 1, 0, 0, 2, 0, 50, 50, 50), indices: Uint32Array.of(0, 1, 2) };
  assertNear(orientedBoundingBox(flat, still).sizeM, [1, 2, 0], "a vertex without triangle does not count");
  assert.equal(Math.min(...orientedBoundingBox(flat, still, { box: "minimal" }).sizeM), 0);
});

test("the smallest box of a turned sheet is that sheet, of a turned L that along its sides", () => {
  forSeeds(60, (random, seed) => {
    const turned = { ...random.pose(), scale: 1 };
    const sheet = boxOf([0.21, 0.297, 0], { ...still, rotation: [0, 0, Math.sin(0.17), Math.cos(0.17)] });
    assertNear(sorted(orientedBoundingBox(sheet, still, { box: "minimal" }).sizeM), [0, 0.21, 0.297], seed, 1e-6);
    const arms = [boxOf([1, 0.2, 0.1], still), boxOf([0.2, 1, 0.1], { ...still, translation: [-0.4, 0.4, 0] })];
    const positions = arms.flatMap((arm) => Array.from(arm.positions));
    const indices = arms.flatMap((arm, k) => Array.from(arm.indices ?? [], (i) => i + 8 * k));
    const bracket = {
      positions: applyToPoints(turned, Float32Array.from(positions)),
      indices: Uint32Array.from(indices),
    };
    assertNear(sorted(orientedBoundingBox(bracket, still, { box: "minimal" }).sizeM), [0.1, 1, 1], seed, 1e-4);
  });
});

/** A mesh that stands along y and looks along z, 2 × 1 × 4 (width, height, length), with its base at the origin. */
const car = boxOf([2, 1, 4], { ...still, translation: [0, 0.5, 0] });

test("cuboids: length to the front, width to the left, height up; yaw seen from above", () => {
  forSeeds(20, (random, seed) => {
    const yaw = random.between(-Math.PI, Math.PI);
    const at: Triple = [random.between(3, 9), random.between(-3, 3), random.between(-1, 1)];
    // In the ROS body frame: front z → x, left x → y, up y → z, then a turn about z.
    const axes = new Matrix4().set(0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1);
    const half = new Matrix4().makeScale(0.5, 0.5, 0.5);
    const inRos = new Matrix4()
      .makeRotationZ(yaw)
      .multiply(axes)
      .multiply(half)
      .setPosition(...at);
    const box = orientedBoundingBox(car, fromFrame(inRos.elements, "ros"));
    const found = toCuboid(box);
    assertNear([...found.size, ...found.center], [2, 1, 0.5, at[0], at[1], at[2] + 0.25], seed);
    assertNear([Math.cos(found.yawRad), Math.sin(found.yawRad)], [Math.cos(yaw), Math.sin(yaw)], seed);
    const turn = new Quaternion().setFromAxisAngle(new Vector3(0, 0, 1), yaw);
    assert.ok(found.tiltRad < 1e-6 && turn.angleTo(new Quaternion(...found.quaternion)) < 1e-6, seed);
    const inOpenGl = toCuboid(box, { frame: "opengl" });
    assertNear([inOpenGl.yawRad, inOpenGl.tiltRad], [found.yawRad, found.tiltRad], seed);
    assertNear(inOpenGl.center, [-found.center[1], found.center[2], -found.center[0]], seed);
  });
  const box = { ...orientedBoundingBox(car, { ...still, translation: [0, 0, 5] }), rotation: [0, 0, 0, 1] as Turn };
  // In the OpenCV camera frame, up is −y: this car lies on its roof.
  assertNear([toCuboid(box).tiltRad], [Math.PI], "tilt");
  const upright = toCuboid(box, { up: "-y", front: "-z" });
  assertNear([upright.tiltRad, Math.abs(upright.yawRad), ...upright.size], [0, Math.PI, 4, 2, 1], "towards the camera");
  assertNear(toCuboid(box, { up: "-y", front: "x" }).size, [2, 4, 1], "a side as the front");
});

/** A corner of the box that CVAT draws for its numbers: a unit box of three.js with position, rotation and scale. */
function drawn(points: readonly number[], corner: Triple): number[] {
  const [position, rotation, scale] = [0, 3, 6].map((at) => points.slice(at, at + 3)) as [Triple, Triple, Triple];
  const turn = new Quaternion().setFromEuler(new Euler(...rotation));
  const matrix = new Matrix4().compose(new Vector3(...position), turn, new Vector3(...scale));
  return new Vector3(...corner).applyMatrix4(matrix).toArray();
}

test("CVAT draws the box around an aligned object, and a round trip gives the same cuboid", () => {
  const rotation = new Quaternion().setFromEuler(new Euler(0.4, -0.9, 2)).toArray() as Turn;
  const box = orientedBoundingBox(mesh, { ...truth, rotation });
  const points = toCvatCuboid(toCuboid(box));
  const inWords = (corners: number[][]) => corners.map((corner) => corner.map((x) => x.toFixed(6)).join()).sort();
  const corners = box.corners.map((_, i) => drawn(points, [(i & 1) - 0.5, ((i >> 1) & 1) - 0.5, (i >> 2) - 0.5]));
  const inRos = (translation: Triple) => toFrame({ ...still, translation }, "ros").translation;
  assert.deepEqual(inWords(corners), inWords(box.corners.map(inRos)));
  forSeeds(100, (random, seed) => {
    // Quarter turns, too.
    const angle = () => (random.between(0, 1) < 0.3 ? (Math.PI / 2) * random.whole(-2, 2) : random.between(-3, 3));
    const turn = new Quaternion().setFromEuler(new Euler(angle(), angle(), angle(), "ZYX")).normalize();
    const [center, size] = [random.list(3, -5, 5), random.list(3, 0.01, 3)] as [Triple, Triple];
    const numbers = toCvatCuboid({ center, size, quaternion: turn.toArray() as Turn });
    const back = fromCvatCuboid(numbers);
    assert.deepEqual([back.center, back.size, numbers.slice(9)], [center, size, [0, 0, 0, 0, 0, 0, 0]], seed);
    assertNear([1 - Math.abs(new Quaternion(...back.quaternion).dot(turn))], [0], seed, 1e-12);
  });
});

test("a box that lies askew in its file gets tight axes, its up and its bottom, and stays where it is", () => {
  forSeeds(15, (random, seed) => {
    const sides = [random.between(0.2, 0.4), random.between(0.5, 0.8), random.between(1, 1.5)];
    const object = boxOf(sides, { scale: 1, rotation: turnOf(random), translation: [0.3, -0.2, 0.1] });
    const transform: Pose = { scale: random.between(0.1, 2), rotation: turnOf(random), translation: [0.1, 0.2, 2] };
    // The box stands on a side: the normal is one of its axes in the camera frame.
    const own = orientedBoundingBox(object, transform, { box: "minimal" });
    const k = random.whole(0, 2);
    const axis = (of: number) => new Vector3(...([0, 1, 2].map((i) => (i === of ? 1 : 0)) as Triple));
    const normal = axis(k)
      .applyQuaternion(new Quaternion(...own.rotation))
      .toArray() as Triple;
    for (const [up, u] of [
      ["y", 1],
      ["z", 2],
    ] as const) {
      const straight = uprightMesh(object, transform, { support: { normal }, up });
      const { positions } = straight.mesh;
      assertNear(applyToPoints(straight.transform, positions), applyToPoints(transform, object.positions), seed, 1e-5);
      const upward = axis(u).applyQuaternion(new Quaternion(...straight.transform.rotation));
      assertNear(upward.toArray(), normal, `${seed}: up`, 1e-6);
      const { low, high, sides: found } = bounds(positions);
      assertNear(sorted(found), sorted(sides), `${seed}: sides`, 1e-5);
      const middle = [0, 1, 2].map((i) => (i === u ? low[i as 0] : low[i as 0] + high[i as 0]));
      assertNear(middle, [0, 0, 0], `${seed}: the origin is in the middle of the bottom`, 1e-5);
      assertNear(compose(transform, straight.meshFromUpright).matrix, straight.transform.matrix, seed);
    }
  });
  const straight: Pose = { scale: 0.5, rotation: [1, 0, 0, 0], translation: [0, 0, 1] };
  assertNear(uprightMesh(boxOf([0.4, 0.9, 0.5], still), straight).meshFromUpright.rotation, [0, 0, 0, 1], "kept", 1e-6);
});

test("a GLB and a scene of upright objects are where they were", async () => {
  const support = { normal: [0.1, -0.9, -0.4], d: 0.8 };
  const straight = uprightMesh(mesh, truth, { support });
  const glb = uprightMesh(mesh, truth, { support, glb: exportGlb(mesh, still, { frame: "opencv" }) });
  assertNear(glb.transform.matrix, straight.transform.matrix, "one frame", 0);
  const placed = exportGlb(glb.mesh, glb.transform, { frame: "opencv" });
  await assertValid(placed);
  assertNear(await verticesOf(placed), applyToPoints(truth, mesh.positions), "the GLB", 1e-5);
  assertNear(await verticesOf(glb.mesh), straight.mesh.positions, "in the upright frame", 1e-5);
  // The origin of a scene follows the origins of its meshes along the ground.
  const objects = [{ mesh, transform: truth }, straight, glb].map(({ mesh, transform }) => ({ mesh, transform }));
  const [own = [], ...others] = await Promise.all(
    objects.map((object) => verticesOf(exportSceneGlb([object], { support }))),
  );
  for (const other of others) {
    const shift = [0, 1, 2].map((k) => (other[k] ?? 0) - (own[k] ?? 0));
    assertNear([shift[1] ?? 1], [0], "heights", 1e-5);
    const shifted = own.map((x, i) => x + (shift[i % 3] ?? 0));
    assertNear(other, shifted, "the scene", 1e-5);
  }
  const { tiltRad } = toCuboid(orientedBoundingBox(straight.mesh, straight.transform), { frame: "opencv" });
  assertNear([Math.cos(tiltRad)], [0.9 / Math.hypot(...support.normal)], "the tilt is that of the support", 1e-6);
});

test("wrong axes, boxes, cuboids and planes are refused", async () => {
  const box = orientedBoundingBox(car, truth);
  const upright = (options: unknown) => () => uprightMesh(mesh, truth, options as never);
  const refused: Refused[] = [
    [() => toCuboid(box, { up: "z" }), "INVALID_OPTION options.up", /"x" or "-x" or "y" or "-y"/],
    [() => orientedBoundingBox(car, truth, { box: "smallest" as never }), "INVALID_OPTION options.box", /"minimal"/],
    [() => fromCvatCuboid([1, 2, 3]), "WRONG_LENGTH points", /16 numbers/],
    [() => toCuboid({ ...box, sizeM: [1, 1, -1] }), "INVALID_ARGUMENT box.sizeM", /above 0/],
    [() => uprightMesh({} as never, truth), "INVALID_ARGUMENT mesh.positions"],
    [upright({ support: { normal: [0, 0, 0] } }), "INVALID_ARGUMENT the length of options.support.normal"],
  ];
  for (const each of refused) await rejectsWith(...each);
});
