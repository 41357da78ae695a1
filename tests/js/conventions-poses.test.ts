/** Transforms in other tools' conventions, against NumPy, three.js and points that were moved by each one's formula. */

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import type { Sim3Like } from "sim3align";
import {
  applyToPoints,
  type CameraFrame,
  compose,
  fromBop,
  fromFrame,
  fromSam3d,
  type GeneratorFrame,
  generatorFrames,
  invert,
  toBop,
  toFrame,
  toGltfNode,
  toRos,
  toRowMajor,
  toSam3d,
  toSim3,
  toThree,
  wxyzFromXyzw,
  xyzwFromWxyz,
} from "sim3align/conventions";
import { Matrix4, Quaternion, Vector3 } from "three";
import { fixtures } from "../support/conventions.js";
import { repository } from "../support/environment.js";
import { type Refusals, refuses, rejectsWith } from "../support/errors.js";
import { assertNear, forSeeds } from "../support/random.js";
import { columnMajor, type Pose, rotationRows, transformed } from "../support/scene.js";

const points = Float64Array.from(fixtures.meshPoints.flat());
const frames = ["opencv", "opengl", "pytorch3d", "ros"] as const;

/** three.js' matrix of a pose. */
const threeMatrix = ({ scale, rotation, translation }: Pose) =>
  new Matrix4().compose(new Vector3(...translation), new Quaternion(...rotation), new Vector3(scale, scale, scale));

/** Every form in which a transform may come. */
const forms = (pose: Pose): [string, Sim3Like][] => [
  ["parts", pose],
  ["rows", { ...pose, rotation: rotationRows(pose.rotation) }],
  ["nine numbers", { ...pose, rotation: rotationRows(pose.rotation).flat() }],
  ["a longer quaternion", { ...pose, rotation: pose.rotation.map((q) => -3 * q) }],
  ["matrix", { matrix: columnMajor(pose) }],
  ["16 numbers", Float64Array.from(columnMajor(pose))],
  ["three.js' elements", threeMatrix(pose).elements],
  ["all forms", toSim3(pose)],
];

test("every form of a transform is understood, and all forms are returned", () => {
  forSeeds(30, (random, seed) => {
    const pose = random.pose();
    for (const [name, form] of forms(pose)) {
      const { scale, rotation, rotationMatrix, translation, matrix } = toSim3(form);
      const where = `${seed}, ${name}`;
      assertNear([scale], [pose.scale], where);
      // A half turn has two quaternions, and q and −q are one rotation.
      const same = new Quaternion(...rotation).angleTo(new Quaternion(...pose.rotation));
      assert.ok(same < 1e-6, `${where}: ${same}`);
      assert.ok(rotation[3] >= 0 && Math.abs(Math.hypot(...rotation) - 1) < 1e-12, where);
      assertNear(rotationMatrix.flat(), rotationRows(pose.rotation).flat(), where);
      assertNear(translation, pose.translation, where);
      assertNear(matrix, columnMajor(pose), where);
      assert.ok(Array.isArray(matrix));
    }
  });
});

test("quaternions survive: those of every rotation, near half turns too", () => {
  forSeeds(200, (random, seed) => {
    const { rotation } = random.pose();
    const back = toSim3({ scale: 1, rotation: rotationRows(rotation), translation: [0, 0, 0] }).rotation;
    const sign = Math.sign(back.reduce((sum, q, i) => sum + q * (rotation[i] ?? 0), 0));
    assertNear(
      back.map((q) => sign * q),
      rotation,
      seed,
      1e-12,
    );
  });
});

test("what a few decimals leave of a rotation is one again", () => {
  forSeeds(20, (random, seed) => {
    const pose = random.pose();
    const rounded = rotationRows(pose.rotation).map((row) => row.map((x) => Math.round(1e4 * x) / 1e4));
    const { rotationMatrix } = toSim3({ ...pose, rotation: rounded });
    const m = new Matrix4().set(
      ...([...rotationMatrix.flatMap((row) => [...row, 0]), 0, 0, 0, 1] as Parameters<Matrix4["set"]>),
    );
    assertNear(m.clone().multiply(m.clone().transpose()).elements, new Matrix4().elements, seed, 1e-14);
    assertNear(rotationMatrix.flat(), rounded.flat(), seed, 2e-4);
  });
});

test("row-major matrices are NumPy's", () => {
  for (const { scale, quaternionWxyz, translation, rowMajor, rotationRows } of fixtures.poses) {
    const rotation = xyzwFromWxyz(quaternionWxyz);
    assertNear(toRowMajor({ scale, rotation, translation }), rowMajor, "from a quaternion");
    assertNear(toRowMajor({ scale, rotation: rotationRows, translation }), rowMajor, "from rows");
    assertNear(wxyzFromXyzw(rotation), quaternionWxyz, "order");
    assert.deepEqual(new Matrix4().fromArray(toSim3({ scale, rotation, translation }).matrix).transpose().elements, [
      ...toRowMajor({ scale, rotation, translation }),
    ]);
  }
});

for (const frame of frames) {
  test(`the frame ${frame} is the one that its axes say`, () => {
    for (const { scale, rotationRows, translation, points: expected } of fixtures.poses) {
      const pose = { scale, rotation: rotationRows, translation };
      const there = toFrame(pose, frame);
      assertNear(applyToPoints(there, points), expected[frame].flat(), frame);
      assertNear(fromFrame(there, frame).matrix, toSim3(pose).matrix, "and back");
    }
  });
}

test("the OpenGL frame is diag(1, −1, −1) times the transform, by three.js", () => {
  forSeeds(20, (random, seed) => {
    const pose = random.pose();
    const expected = new Matrix4().makeScale(1, -1, -1).multiply(threeMatrix(pose));
    const found = toFrame(pose, "opengl");
    assertNear(found.matrix, expected.elements, seed);
    const { matrix, position, quaternion, scale } = toThree(pose);
    assert.deepEqual(matrix, found.matrix, seed);
    const composed = new Matrix4().compose(
      new Vector3(...position),
      new Quaternion(...quaternion),
      new Vector3(...scale),
    );
    assertNear(composed.elements, expected.elements, seed);
  });
});

test("compose and invert are three.js' multiply and invert", () => {
  forSeeds(20, (random, seed) => {
    const [a, b, c] = [random.pose(), random.pose(), random.pose()];
    const expected = threeMatrix(a).multiply(threeMatrix(b)).multiply(threeMatrix(c));
    assertNear(compose(a, b, c).matrix, expected.elements, seed);
    assertNear(compose(a).matrix, threeMatrix(a).elements, seed);
    assertNear(invert(a).matrix, threeMatrix(a).invert().elements, seed);
    assertNear(compose(a, invert(a)).matrix, new Matrix4().elements, seed);
  });
});

test("applyToPoints moves points, in arrays of the same kind, and leaves the given ones", () => {
  forSeeds(10, (random, seed) => {
    const pose = random.pose();
    const given = Float32Array.from(random.list(300, -2, 2));
    const before = given.slice();
    const moved = applyToPoints(pose, given);
    assert.ok(moved instanceof Float32Array);
    assertNear(moved, transformed(given, pose), seed, 1e-6);
    assert.deepEqual(given, before);
    assertNear(applyToPoints(invert(pose), moved), given, seed, 1e-4);
  });
});

test("toRos has positions in the body frame, or the optical one", () => {
  for (const { scale, rotationRows, translation, points: expected } of fixtures.poses) {
    const transform = { scale, rotation: rotationRows, translation };
    for (const [frame, name] of [
      ["body", "ros"],
      ["optical", "opencv"],
    ] as const) {
      const { position, orientation, scale: scaled } = toRos(transform, { frame });
      const pose = {
        scale: scaled,
        rotation: Object.values(orientation) as Pose["rotation"],
        translation: Object.values(position) as Pose["translation"],
      };
      assert.deepEqual(Object.keys(orientation), ["x", "y", "z", "w"]);
      assertNear(transformed(points, pose), expected[name].flat(), frame);
    }
    assert.deepEqual(toRos(transform), toRos(transform, { frame: "body" }));
  }
});

test("BOP's poses move models in millimetres, and survive", () => {
  for (const { entry, modelMm, inCameraMm } of fixtures.bop) {
    const model = Float64Array.from(modelMm.flat());
    const pose = fromBop(entry);
    const inCamera = applyToPoints(pose, model).map((metres) => 1000 * metres);
    assertNear(inCamera, inCameraMm.flat(), "a model in millimetres");
    const { entry: back, scale } = toBop(pose, { objId: 5 });
    assertNear(back.cam_R_m2c, entry.cam_R_m2c, "R");
    assertNear(back.cam_t_m2c, entry.cam_t_m2c, "t");
    assert.equal(back.obj_id, 5);
    assertNear([scale], [0.001], "scale");
    assert.equal("obj_id" in toBop(pose).entry, false);
  }
  forSeeds(10, (random, seed) => {
    const pose = random.pose();
    const { entry, scale } = toBop(pose);
    assertNear(fromBop(entry, { scale }).matrix, columnMajor(pose), seed);
  });
});

test("SAM 3D Objects' layouts put GLB vertices where its formula puts them, and survive", () => {
  for (const { layout, zUp, inOpenCv } of fixtures.sam3d) {
    assertNear(applyToPoints(fromSam3d(layout), points), inOpenCv.flat(), "GLB");
    const ofGaussians = fromSam3d(layout, { vertices: "z-up" });
    assertNear(applyToPoints(ofGaussians, Float64Array.from(zUp.flat())), inOpenCv.flat(), "Gaussians");
    const flat = {
      scale: layout.scale.flat()[0] ?? 0,
      rotation: layout.rotation.flat(),
      translation: layout.translation,
    };
    assert.deepEqual(fromSam3d(flat), fromSam3d(layout));
    for (const vertices of ["glb", "z-up"] as const) {
      const back = toSam3d(fromSam3d(layout, { vertices }), { vertices });
      assertNear(back.scale, layout.scale.flat(), "scale");
      assertNear(back.translation, layout.translation.flat(), "translation");
      const sign = Math.sign(layout.rotation.flat()[0] ?? 1);
      assertNear(
        back.rotation,
        layout.rotation.flat().map((q) => sign * q),
        "rotation",
      );
    }
  }
  forSeeds(10, (random, seed) => {
    const pose = random.pose();
    assertNear(fromSam3d(toSam3d(pose)).matrix, columnMajor(pose), seed);
  });
});

test("an asymmetric object is upright, and seen from its front, by the frame of each generator's file", () => {
  const along = (vertices: number[][], [x, y, z]: readonly [number, number, number]) =>
    vertices.map(([a = 0, b = 0, c = 0]) => x * a + y * b + z * c);
  const frameOf = (name: string, file: string) =>
    (generatorFrames as unknown as Record<string, Record<string, GeneratorFrame>>)[name]?.[file];
  const tested = fixtures.generators.map(({ generator, file, vertices, heights, towardsCamera }) => {
    const { up, front } = frameOf(generator, file) ?? assert.fail(`${generator} ${file}`);
    assertNear(along(vertices, up), heights, `${generator}, ${file}: up`);
    assert.equal(front === null, towardsCamera === null, generator);
    if (front !== null && towardsCamera !== null)
      assertNear(along(vertices, front), towardsCamera, `${generator}: front`);
    return `${generator} ${file}`;
  });
  const all = Object.entries(generatorFrames).flatMap(([name, files]) =>
    Object.keys(files).map((file) => `${name} ${file}`),
  );
  assert.deepEqual(tested.sort(), all.sort());
  // The guide says the same.
  const guide = readFileSync(join(repository, "docs", "guides", "generators.md"), "utf8");
  const axis = (name: string) =>
    name === "–" ? null : ["x", "y", "z"].map((one) => (name.endsWith(one) ? (name.startsWith("−") ? -1 : 1) : 0));
  const rows = [...guide.matchAll(/^\| [^|]+ \| `(\w+)\.(\w+)` \| (\S+) \| (\S+) \|/gm)].map((row) => row.slice(1));
  assert.deepEqual(rows.map(([name, file]) => `${name} ${file}`).sort(), all.sort());
  for (const [name = "", file = "", up = "", front = ""] of rows) {
    assert.deepEqual(frameOf(name, file), { up: axis(up), front: axis(front) }, `${name}, ${file}`);
  }
  // The vertices of SAM 3D's layouts have z up.
  assert.deepEqual(generatorFrames.sam3d.gaussians.up, [0, 0, 1]);
});

test("glTF's nodes have the transform in parts, and what is known in extras", () => {
  forSeeds(10, (random, seed) => {
    const pose = random.pose();
    const { translation, rotation, scale } = toGltfNode(pose);
    const node = new Matrix4().compose(new Vector3(...translation), new Quaternion(...rotation), new Vector3(...scale));
    assertNear(node.elements, toFrame(pose, "opengl").matrix, seed);
    const asItIs = toGltfNode(pose, { frame: "opencv" });
    assertNear(asItIs.translation, pose.translation, seed);
    assert.equal(asItIs.extras.sim3align.metresPerUnit, pose.scale);
  });
  const result = { ...toSim3({ scale: 1, rotation: [0, 0, 0, 1], translation: [0, 0, 1] }), metrics: { iou: 0.9 } };
  assert.deepEqual(toGltfNode({ ...result, confidence: 0.8 } as Sim3Like).extras, {
    sim3align: { frame: "opengl", metresPerUnit: 1, metrics: { iou: 0.9 }, confidence: 0.8 },
  });
  assert.deepEqual(toGltfNode(result, { metrics: { iou: 1 }, name: "mug" }).extras.sim3align.metrics, { iou: 1 });
  assert.equal("metrics" in toGltfNode(result, { metrics: null }).extras.sim3align, false);
  assert.equal(toGltfNode(result, { name: "mug" }).name, "mug");
});

const bad: Refusals<unknown> = {
  "nothing: INVALID_ARGUMENT transform": [undefined, /16 numbers/],
  "too few numbers: WRONG_LENGTH transform": [[1, 2, 3], /3 numbers/],
  "a row-major matrix: INVALID_TRANSFORM transform": [[1, 0, 0, 5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], /Transpose/],
  "a mirror image: INVALID_TRANSFORM transform": [new Matrix4().makeScale(1, 1, -1).elements, /determinant -1/],
  "a stretch: INVALID_TRANSFORM transform": [new Matrix4().makeScale(1, 2, 1).elements, /orthonormal/],
  "no scale: INVALID_TRANSFORM transform": [new Matrix4().makeScale(0, 0, 0).elements, /scale/],
  "a scale of 0: INVALID_TRANSFORM transform.scale": [
    { scale: 0, rotation: [0, 0, 0, 1], translation: [0, 0, 0] },
    /above 0/,
  ],
  "a quaternion of 0: INVALID_TRANSFORM transform.rotation": [
    { scale: 1, rotation: [0, 0, 0, 0], translation: [0, 0, 0] },
    /other than 0/,
  ],
  "a translation that is none: NON_FINITE transform.translation": [
    { scale: 1, rotation: [0, 0, 0, 1], translation: [0, Number.NaN, 0] },
    /NaN/,
  ],
  "no rotation: INVALID_ARGUMENT transform.rotation": [{ scale: 1, translation: [0, 0, 0] }, /quaternion/],
};

refuses(bad, (transform) => toSim3(transform as Sim3Like));

test("other wrong arguments are named", async () => {
  const identity = toSim3(new Matrix4().elements);
  await rejectsWith(() => toFrame(identity, "blender" as CameraFrame), "INVALID_OPTION frame", /"opencv" or "opengl"/);
  await rejectsWith(() => compose(identity, [1] as unknown as Sim3Like), "WRONG_LENGTH transforms[1]", /1 numbers/);
  await rejectsWith(() => applyToPoints(identity, new Float32Array(4)), "WRONG_LENGTH points", /x, y, z per point/);
  await rejectsWith(
    () => applyToPoints(identity, [1, 2, 3] as unknown as Float32Array),
    "INVALID_ARGUMENT points",
    /Float32Array.from\(points\)/,
  );
  await rejectsWith(
    () => fromSam3d({ scale: [1, 2, 1], rotation: [1, 0, 0, 0], translation: [0, 0, 1] }),
    "INVALID_TRANSFORM layout.scale",
    /uniform scale/,
  );
  await rejectsWith(
    () => fromBop({ cam_R_m2c: [1, 0, 0], cam_t_m2c: [0, 0, 1] }),
    "WRONG_LENGTH entry.cam_R_m2c",
    /nine/,
  );
});
