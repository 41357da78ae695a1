/** Real dimensions and cuboids, against boxes that were built to size. */
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  applyToPoints,
  fromFrame,
  type OrientedBoundingBox,
  orientedBoundingBox,
  toCuboid,
  toFrame,
} from "sim3align/conventions";
import { Matrix4, Quaternion, Vector3 } from "three";
import { rejectsWith } from "../support/errors.js";
import { assertNear, forSeeds, type Random } from "../support/random.js";
import { blob, type Mesh, mesh, type Pose, truth } from "../support/scene.js";

/** A box of these sides, its faces divided, turned and moved in the mesh's own frame. */
function boxMesh(sides: readonly number[], pose: Pose, random: Random): Mesh {
  const corners = Array.from({ length: 8 }, (_, i) =>
    [i & 1, (i >> 1) & 1, i >> 2].map((bit, k) => (bit - 0.5) * (sides[k] ?? 0)),
  );
  const faces = [
    [0, 2, 3, 1],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 4, 6, 2],
    [1, 3, 7, 5],
  ];
  // Points inside a face move the mean of the vertices, not the box.
  const positions = corners.flat();
  const indices: number[] = [];
  for (const face of faces) {
    const middle = positions.length / 3;
    const weights = face.map(() => random.between(0.1, 1));
    const sum = weights.reduce((a, b) => a + b);
    positions.push(
      ...[0, 1, 2].map((k) => face.reduce((at, c, j) => at + ((weights[j] ?? 0) * (corners[c]?.[k] ?? 0)) / sum, 0)),
    );
    indices.push(...face.flatMap((corner, j) => [corner, face[(j + 1) % 4] ?? 0, middle]));
  }
  const turned = applyToPoints(pose, Float64Array.from(positions));
  return { positions: Float32Array.from(turned), indices: Uint32Array.from(indices) };
}

const near = (a: readonly number[], b: readonly number[], message: string, tolerance = 1e-5) =>
  assertNear(
    [...a].sort((x, y) => x - y),
    [...b].sort((x, y) => x - y),
    message,
    tolerance,
  );

/** Checks that a box's parts say the same, and that points are within it. */
function assertHolds(box: OrientedBoundingBox, points: Float32Array | Float64Array, message: string): void {
  const inBox = new Matrix4()
    .compose(new Vector3(...box.centerM), new Quaternion(...box.rotation), new Vector3(1, 1, 1))
    .invert();
  const reach = 1e-5 * Math.hypot(...box.centerM, ...box.sizeM);
  for (let i = 0; i < points.length; i += 3) {
    const point = new Vector3().fromArray(points, i).applyMatrix4(inBox).toArray();
    const isInside = point.every((x, k) => Math.abs(x) <= (box.sizeM[k as 0] ?? 0) / 2 + reach);
    assert.ok(isInside, `${message}: vertex ${i / 3}`);
  }
  box.corners.forEach((corner, i) => {
    const expected = [i & 1, (i >> 1) & 1, i >> 2].map((bit, k) => (bit - 0.5) * (box.sizeM[k as 0] ?? 0));
    assertNear(new Vector3(...corner).applyMatrix4(inBox).toArray(), expected, `${message}: corner ${i}`, reach);
  });
}

test("the box along the mesh's axes has its extents, scaled, and holds every vertex", () => {
  const box = orientedBoundingBox(mesh, truth);
  const extents = [0, 1, 2].map((k) => {
    const along = Array.from(mesh.positions).filter((_, i) => i % 3 === k);
    return truth.scale * (Math.max(...along) - Math.min(...along));
  });
  assertNear(box.sizeM, extents, "size");
  const same = new Quaternion(...box.rotation).angleTo(new Quaternion(...truth.rotation));
  assert.ok(same < 1e-6, `${same}`);
  const [low, high] = [new Vector3(...box.corners[0]), new Vector3(...box.corners[7])];
  assertNear(low.clone().add(high).multiplyScalar(0.5).toArray(), box.centerM, "centre");
  assertHolds(box, applyToPoints(truth, mesh.positions), "truth");
});

test("the smallest box around a turned box is that box", () => {
  forSeeds(40, (random, seed) => {
    const sides = random.list(3, 0.2, 2);
    const inside = { ...random.pose(), scale: 1 };
    const pose = random.pose();
    const object = boxMesh(sides, inside, random);
    const box = orientedBoundingBox(object, pose, { box: "minimal" });
    assertHolds(box, applyToPoints(pose, Float64Array.from(object.positions)), seed);
    near(
      box.sizeM,
      sides.map((side) => side * pose.scale),
      seed,
    );
    const center = applyToPoints(pose, Float64Array.from(inside.translation));
    assertNear(box.centerM, center, seed, 1e-5);
  });
});

test("an upright box keeps its axes' names when it is the smallest", () => {
  forSeeds(5, (random, seed) => {
    const still: Pose = { scale: 1, rotation: [0, 0, 0, 1], translation: [0.1, 0.2, 0.3] };
    const object = boxMesh([0.3, 2, 1], still, random);
    const [plain, minimal] = [
      orientedBoundingBox(object, truth),
      orientedBoundingBox(object, truth, { box: "minimal" }),
    ];
    assertNear(minimal.sizeM, plain.sizeM, seed);
    assertNear(minimal.rotation, plain.rotation, seed);
  });
});

test("the smallest box is never larger than the plain one, nor than any of many others, by more than 2 %", () => {
  const fine = blob(60, 90);
  assert.ok(fine.positions.length / 3 > 2000, "so many that only the outermost are looked at");
  for (const object of [mesh, fine]) {
    const volume = ([a, b, c]: readonly [number, number, number]) => a * b * c;
    const found = volume(orientedBoundingBox(object, truth, { box: "minimal" }).sizeM);
    forSeeds(300, (random, seed) => {
      const turn = { ...random.pose(), scale: truth.scale };
      const other = volume(
        orientedBoundingBox({ ...object, positions: applyToPoints({ ...turn, scale: 1 }, object.positions) }, truth)
          .sizeM,
      );
      assert.ok(found <= other * 1.02, `${seed}: ${found} against ${other}`);
    });
    assert.ok(found <= volume(orientedBoundingBox(object, truth).sizeM) * (1 + 1e-6));
  }
});

test("flat meshes, and vertices that no triangle has", () => {
  const positions = Float32Array.of(0, 0, 0, 1, 1, 0, 0, 2, 0, 50, 50, 50);
  const flat = { positions, indices: Uint32Array.of(0, 1, 2) };
  const unit = { scale: 1, rotation: [0, 0, 0, 1], translation: [0, 0, 0] };
  assertNear(orientedBoundingBox(flat, unit).sizeM, [1, 2, 0], "the stray vertex does not count");
  const { sizeM } = orientedBoundingBox(flat, unit, { box: "minimal" });
  assert.ok(Math.min(...sizeM) === 0 && sizeM.every(Number.isFinite), `${sizeM}`);
});

/** A mesh that stands along y and looks along z, 2 × 1 × 4 (width, height, length), with its base at the origin. */
const car = {
  positions: Float32Array.from(
    [0, 1, 2, 3, 4, 5, 6, 7].flatMap((i) => [i & 1 ? 1 : -1, i & 2 ? 1 : 0, i & 4 ? 2 : -2]),
  ),
  indices: Uint32Array.of(0, 1, 2, 5, 6, 7, 3, 4, 5),
};

test("cuboids: length to the front, width to the left, height up; yaw seen from above", () => {
  forSeeds(20, (random, seed) => {
    const yaw = random.between(-Math.PI, Math.PI);
    // In the ROS body frame: front z → x, left x → y, up y → z, then a turn about z.
    const rows = new Matrix4()
      .makeRotationZ(yaw)
      .multiply(new Matrix4().set(0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1));
    const at: [number, number, number] = [random.between(3, 9), random.between(-3, 3), random.between(-1, 1)];
    const inRos = rows.multiply(new Matrix4().makeScale(0.5, 0.5, 0.5)).setPosition(...at);
    const box = orientedBoundingBox(car, fromFrame(inRos.elements, "ros"));
    const cuboid = toCuboid(box);
    assertNear(cuboid.size, [2, 1, 0.5], seed);
    assertNear(cuboid.center, [at[0], at[1], at[2] + 0.25], seed);
    assertNear([Math.cos(cuboid.yawRad), Math.sin(cuboid.yawRad)], [Math.cos(yaw), Math.sin(yaw)], seed);
    assert.ok(cuboid.tiltRad < 1e-6, seed);
    const turn = new Quaternion().setFromAxisAngle(new Vector3(0, 0, 1), yaw);
    assert.ok(turn.angleTo(new Quaternion(...cuboid.quaternion)) < 1e-6, seed);
    // The same cuboid in another frame: the same yaw, and the centre turned.
    const inOpenGL = toCuboid(box, { frame: "opengl" });
    assertNear([inOpenGL.yawRad, inOpenGL.tiltRad], [cuboid.yawRad, cuboid.tiltRad], seed);
    assertNear(inOpenGL.center, [-cuboid.center[1], cuboid.center[2], -cuboid.center[0]], seed);
  });
});

test("cuboids of meshes with other fronts and ups", () => {
  const still = toFrame({ scale: 1, rotation: [0, 0, 0, 1], translation: [0, 0, 5] }, "opencv");
  const box = { ...orientedBoundingBox(car, still), rotation: [0, 0, 0, 1] as [number, number, number, number] };
  // In the OpenCV camera frame, up is −y: this car lies on its roof.
  const upsideDown = toCuboid(box);
  assertNear([upsideDown.tiltRad], [Math.PI], "tilt");
  const upright = toCuboid(box, { up: "-y", front: "-z" });
  assertNear([upright.tiltRad, Math.abs(upright.yawRad)], [0, Math.PI], "towards the camera");
  assertNear(upright.size, [4, 2, 1], "size");
  assertNear(toCuboid(box, { up: "-y", front: "x" }).size, [2, 4, 1], "a side as the front");
});

test("wrong axes and boxes are refused", async () => {
  const box = orientedBoundingBox(car, truth);
  await rejectsWith(() => toCuboid(box, { up: "z" }), "INVALID_OPTION options.up", /"x" or "-x" or "y" or "-y"/);
  await rejectsWith(() => toCuboid(box, { front: "forward" as never }), "INVALID_OPTION options.front", /"-z"/);
  await rejectsWith(() => toCuboid({ ...box, sizeM: [1, 1, -1] }), "INVALID_ARGUMENT box.sizeM", /above 0/);
  await rejectsWith(
    () => orientedBoundingBox(car, truth, { box: "smallest" as never }),
    "INVALID_OPTION options.box",
    /"axes" or "minimal"/,
  );
});
