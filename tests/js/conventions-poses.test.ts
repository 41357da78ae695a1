/** Transforms in other tools' conventions, against NumPy, three.js and points that were moved by each one's formula. */
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Sim3Like } from "sim3align";
import {
  applyToPoints,
  bopSymmetries,
  compose,
  fromBop,
  fromFrame,
  fromSam3d,
  generatorFrames,
  invert,
  toBop,
  toFrame,
  toRowMajor,
  toSam3d,
  toSim3,
} from "sim3align/conventions";
import { Matrix4, Quaternion, Vector3 } from "three";
import { fixtures } from "../support/conventions.js";
import { type Refused, rejectsWith } from "../support/errors.js";
import { assertNear, forSeeds } from "../support/random.js";
import { columnMajor, type Pose, rotationRows } from "../support/scene.js";

const points = Float64Array.from(fixtures.meshPoints.flat());

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
  forSeeds(100, (random, seed) => {
    const pose = random.pose();
    for (const [name, form] of forms(pose)) {
      const { scale, rotation, rotationMatrix, translation, matrix } = toSim3(form);
      const where = `${seed}, ${name}`;
      // A half turn has two quaternions, and q and −q are one rotation.
      const sign = Math.sign(rotation.reduce((sum, q, i) => sum + q * (pose.rotation[i] ?? 0), 0));
      assertNear([scale, ...rotation.map((q) => sign * q)], [pose.scale, ...pose.rotation], where);
      assert.ok(rotation[3] >= 0 && Math.abs(Math.hypot(...rotation) - 1) < 1e-12, where);
      assertNear(rotationMatrix.flat(), rotationRows(pose.rotation).flat(), where);
      assertNear([...translation, ...matrix], [...pose.translation, ...columnMajor(pose)], where);
      assert.ok(Array.isArray(matrix));
    }
    const rounded = rotationRows(pose.rotation).map((row) => row.map((x) => Math.round(1e4 * x) / 1e4));
    const { rotationMatrix } = toSim3({ ...pose, rotation: rounded });
    const products = rotationMatrix.map((a) => rotationMatrix.map((b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2]));
    assertNear(products.flat(), [1, 0, 0, 0, 1, 0, 0, 0, 1], `${seed}: a few decimals are a rotation again`, 1e-14);
    assertNear(rotationMatrix.flat(), rounded.flat(), seed, 2e-4);
  });
});

test("row-major matrices are NumPy's, and each frame is the one that its axes say", () => {
  for (const { scale, quaternionWxyz, translation, rowMajor, rotationRows, points: expected } of fixtures.poses) {
    const [w = 0, ...xyz] = quaternionWxyz;
    const rotation = [...xyz, w];
    assertNear(toRowMajor({ scale, rotation, translation }), rowMajor, "from a quaternion");
    const pose = { scale, rotation: rotationRows, translation };
    assertNear(toRowMajor(pose), rowMajor, "from rows");
    for (const frame of ["opencv", "opengl", "pytorch3d", "ros"] as const) {
      assertNear(applyToPoints(toFrame(pose, frame), points), expected[frame].flat(), frame);
      assertNear(fromFrame(toFrame(pose, frame), frame).matrix, toSim3(pose).matrix, `${frame} and back`);
    }
  }
});

test("OpenGL's frame, compose and invert: by three.js", () => {
  forSeeds(20, (random, seed) => {
    const [a, b, c] = [random.pose(), random.pose(), random.pose()];
    const expected = new Matrix4().makeScale(1, -1, -1).multiply(threeMatrix(a));
    const { matrix, translation, rotation, scale } = toFrame(a, "opengl");
    const [place, turned] = [new Vector3(...translation), new Quaternion(...rotation)];
    const composed = new Matrix4().compose(place, turned, new Vector3(scale, scale, scale));
    for (const found of [matrix, composed.elements]) assertNear(found, expected.elements, seed);
    const product = threeMatrix(a).multiply(threeMatrix(b)).multiply(threeMatrix(c));
    assertNear(compose(a, b, c).matrix, product.elements, seed);
    assertNear(compose(a).matrix, threeMatrix(a).elements, seed);
    assertNear(invert(a).matrix, threeMatrix(a).invert().elements, seed);
    assertNear(compose(a, invert(a)).matrix, new Matrix4().elements, seed);
  });
});

test("BOP's poses move models in millimetres, and survive", () => {
  for (const { entry, modelMm, inCameraMm } of fixtures.bop) {
    const pose = fromBop(entry);
    const inCamera = applyToPoints(pose, Float64Array.from(modelMm.flat())).map((metres) => 1000 * metres);
    assertNear(inCamera, inCameraMm.flat(), "a model in millimetres");
    const { entry: back, scale } = toBop(pose, { objId: 5 });
    assertNear([...back.cam_R_m2c, ...back.cam_t_m2c, scale], [...entry.cam_R_m2c, ...entry.cam_t_m2c, 0.001], "back");
    assert.deepEqual([back.obj_id, "obj_id" in toBop(pose).entry], [5, false]);
  }
  forSeeds(10, (random, seed) => {
    const pose = random.pose();
    const { entry, scale } = toBop(pose);
    assertNear(fromBop(entry, { scale }).matrix, columnMajor(pose), seed);
  });
});

test("symmetries of BOP map a model onto itself, about its centroid", async () => {
  // A square prism away from the origin of its mesh.
  const corners = [-1, 1].flatMap((x) => [-1, 1].flatMap((y) => [-3, 3].map((z) => [x + 5, y - 2, z + 1] as const)));
  const quads = [
    [0, 2, 6, 4],
    [1, 5, 7, 3],
    [0, 4, 5, 1],
    [2, 3, 7, 6],
    [0, 1, 3, 2],
    [4, 6, 7, 5],
  ] as const;
  const indices = Uint32Array.from(quads.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]));
  const mesh = { positions: Float32Array.from(corners.flat()), indices };
  const model = corners.map((corner) => corner.map((x) => 20 * x));

  const axes = [
    { axis: [0, 0, 2], fold: 4 },
    { axis: [1, 0, 0], fold: 2 },
  ] as const;
  const { symmetries_discrete = [], ...rest } = bopSymmetries(axes, mesh, { scale: 0.02 });
  assert.deepEqual([symmetries_discrete.length, rest], [7, {}]);
  for (const m of symmetries_discrete) {
    const moved = model.map((p) =>
      [0, 4, 8].map((r) => [0, 1, 2].reduce((sum, c) => sum + (m[r + c] ?? 0) * (p[c] ?? 0), m[r + 3] ?? 0)),
    );
    const isCorner = (p: number[]) => model.some((q) => Math.hypot(...q.map((x, i) => x - (p[i] ?? 0))) < 1e-9);
    assert.ok(moved.every(isCorner), m.join());
  }

  const { symmetries_continuous } = bopSymmetries([{ axis: [0, 0, 2] }], mesh, { scale: 0.02 });
  assert.deepEqual(
    symmetries_continuous?.map(({ axis }) => axis),
    [[0, 0, 1]],
  );
  assertNear(symmetries_continuous?.[0]?.offset ?? [], [100, -40, 20], "a point on the axis");
  assert.deepEqual(bopSymmetries([], mesh), {});
  const infinite = [
    { axis: [0, 0, 1], fold: 4 },
    { axis: [0, 1, 1], fold: 5 },
  ] as const;
  await rejectsWith(() => bopSymmetries(infinite, mesh), "INVALID_OPTION symmetry");
});

test("SAM 3D Objects' layouts put vertices where its formula puts them, and survive", () => {
  for (const { layout, zUp, inOpenCv } of fixtures.sam3d) {
    assertNear(applyToPoints(fromSam3d(layout), points), inOpenCv.flat(), "GLB");
    const gaussians = Float64Array.from(zUp.flat());
    assertNear(applyToPoints(fromSam3d(layout, { vertices: "z-up" }), gaussians), inOpenCv.flat(), "Gaussians");
    const [rotation, translation, scale] = [layout.rotation.flat(), layout.translation, layout.scale.flat()[0] ?? 0];
    assert.deepEqual(fromSam3d({ scale, rotation, translation }), fromSam3d(layout));
    for (const vertices of ["glb", "z-up"] as const) {
      const back = toSam3d(fromSam3d(layout, { vertices }), { vertices });
      const sign = Math.sign(rotation[0] ?? 1);
      const rotated = rotation.map((q) => sign * q);
      assertNear(back.rotation, rotated, "rotation");
      assertNear([...back.scale, ...back.translation], [...layout.scale.flat(), ...translation.flat()], "the rest");
    }
  }
});

test("an object is upright, and seen from its front, by the frame of each generator's file", () => {
  const along = (vertices: number[][], [x, y, z]: readonly [number, number, number]) =>
    vertices.map(([a = 0, b = 0, c = 0]) => x * a + y * b + z * c);
  const frameOf = (name: string, file: string) =>
    (generatorFrames as unknown as Record<string, Record<string, typeof generatorFrames.sam3d.mesh>>)[name]?.[file];
  const tested = fixtures.generators.map(({ generator, file, vertices, heights, towardsCamera }) => {
    const { up, front } = frameOf(generator, file) ?? assert.fail(`${generator} ${file}`);
    assertNear(along(vertices, up), heights, `${generator}, ${file}: up`);
    assert.deepEqual(front === null, towardsCamera === null, generator);
    if (front !== null && towardsCamera !== null) assertNear(along(vertices, front), towardsCamera, generator);
    return `${generator} ${file}`;
  });
  const all = Object.entries(generatorFrames).flatMap(([name, files]) =>
    Object.keys(files).map((file) => `${name} ${file}`),
  );
  assert.deepEqual(tested.sort(), all.sort());
});

test("what is no transform, frame or layout is refused", async () => {
  const unit = { scale: 1, rotation: [0, 0, 0, 1], translation: [0, 0, 0] };
  const sim3 = (transform: unknown) => () => toSim3(transform as Sim3Like);
  const bop = { cam_R_m2c: [1, 0, 0], cam_t_m2c: [0, 0, 1] };
  const refused: Refused[] = [
    [sim3(undefined), "INVALID_ARGUMENT transform", /16 numbers/],
    [sim3([1, 0, 0, 5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]), "INVALID_TRANSFORM transform", /Transpose/],
    [sim3(new Matrix4().makeScale(1, 1, -1).elements), "INVALID_TRANSFORM transform", /determinant -1/],
    [sim3(new Matrix4().makeScale(1, 2, 1).elements), "INVALID_TRANSFORM transform", /orthonormal/],
    [sim3({ ...unit, scale: 0 }), "INVALID_TRANSFORM transform.scale", /above 0/],
    [sim3({ ...unit, translation: [0, Number.NaN, 0] }), "NON_FINITE transform.translation", /NaN/],
    [() => toFrame(unit, "blender" as never), "INVALID_OPTION frame", /"opencv" or "opengl"/],
    [() => applyToPoints(unit, new Float32Array(4)), "WRONG_LENGTH points", /x, y, z per point/],
    [() => fromSam3d({ ...unit, scale: [1, 2, 1] }), "INVALID_TRANSFORM layout.scale", /uniform scale/],
    [() => fromBop(bop), "WRONG_LENGTH entry.cam_R_m2c", /nine/],
  ];
  for (const each of refused) await rejectsWith(...each);
});
