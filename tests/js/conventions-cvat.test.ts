/** Cuboids of CVAT, against how CVAT draws them: a unit box of three.js with position, rotation and scale. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { fromCvatCuboid, orientedBoundingBox, toCuboid, toCvatCuboid, toFrame } from "sim3align/conventions";
import { Euler, Matrix4, Quaternion, Vector3 } from "three";
import { rejectsWith } from "../support/errors.js";
import { assertNear, forSeeds } from "../support/random.js";
import { blob, truth } from "../support/scene.js";

type Three = [number, number, number];
type Four = [number, number, number, number];

/** A corner of the box that CVAT draws for these numbers. */
function drawn(points: readonly number[], corner: Three): number[] {
  const [position, rotation, scale] = [0, 3, 6].map((at) => points.slice(at, at + 3) as Three) as [Three, Three, Three];
  const turn = new Quaternion().setFromEuler(new Euler(...rotation));
  return new Vector3(...corner)
    .applyMatrix4(new Matrix4().compose(new Vector3(...position), turn, new Vector3(...scale)))
    .toArray();
}

test("CVAT draws the box around an aligned object", () => {
  const mesh = blob();
  const transform = { ...truth, rotation: new Quaternion().setFromEuler(new Euler(0.4, -0.9, 2)).toArray() as Four };
  const box = orientedBoundingBox(mesh, transform);
  const points = toCvatCuboid(toCuboid(box));
  assert.equal(points.length, 16);
  const sort = (corners: number[][]) => corners.map((corner) => corner.map((x) => x.toFixed(6)).join()).sort();
  // The same place for the camera of the box and the ROS frame of the cuboid.
  const inRos = (corner: Three) =>
    toFrame({ scale: 1, rotation: [0, 0, 0, 1], translation: corner }, "ros").translation;
  const corners = Array.from({ length: 8 }, (_, i) =>
    drawn(points, [(i & 1) - 0.5, ((i >> 1) & 1) - 0.5, (i >> 2) - 0.5]),
  );
  assert.deepEqual(sort(corners), sort(box.corners.map(inRos)));
});

test("a round trip gives the same cuboid, also with quarter turns", () => {
  const quarter = Math.PI / 2;
  forSeeds(200, (random, seed) => {
    const angle = () =>
      random.between(0, 1) < 0.3 ? quarter * Math.round(random.between(-2, 2)) : random.between(-3, 3);
    const turn = new Quaternion().setFromEuler(new Euler(angle(), angle(), angle(), "ZYX")).normalize();
    const [x, y, z] = [random.between(-5, 5), random.between(-5, 5), random.between(-5, 5)];
    const size: Three = [random.between(0.01, 3), random.between(0.01, 3), random.between(0.01, 3)];
    const cuboid = { center: [x, y, z] as Three, size, quaternion: turn.toArray() as Four };
    const points = toCvatCuboid(cuboid);
    const back = fromCvatCuboid(points);
    assert.deepEqual([back.center, back.size], [cuboid.center, cuboid.size], seed);
    assertNear([1 - Math.abs(new Quaternion(...back.quaternion).dot(turn))], [0], seed, 1e-12);
    assert.deepEqual(points.slice(9), [0, 0, 0, 0, 0, 0, 0]);
    // An editor that turns about z alone keeps the others.
    const again = toCvatCuboid(fromCvatCuboid(points));
    assertNear(drawn(again, [0.5, 0.5, 0.5]), drawn(points, [0.5, 0.5, 0.5]), seed, 1e-6);
  });
});

test("other numbers are refused", async () => {
  await rejectsWith(() => fromCvatCuboid([1, 2, 3]), "WRONG_LENGTH points", /16 numbers/);
  await rejectsWith(
    () => fromCvatCuboid([0, 0, 0, 0, 0, 0, 1, 1, -1, 0, 0, 0, 0, 0, 0, 0]),
    "INVALID_ARGUMENT points",
    /above 0/,
  );
  await rejectsWith(
    () => toCvatCuboid({ center: [0, 0, 0], size: [1, 0, 1], quaternion: [0, 0, 0, 1] }),
    "INVALID_ARGUMENT cuboid.size",
    /above 0/,
  );
});
