/** `sim3align/three` with three.js itself. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner } from "sim3align";
import { toFrame } from "sim3align/conventions";
import {
  applyPinhole,
  applyToObject3D,
  cameraFromPinhole,
  meshInputFromThree,
  transformFromObject3D,
} from "sim3align/three";
import {
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  Group,
  InstancedMesh,
  InterleavedBuffer,
  InterleavedBufferAttribute,
  Matrix4,
  Mesh,
  PerspectiveCamera,
  Quaternion,
  Scene,
  Vector3,
  WebGPUCoordinateSystem,
} from "three";
import { rejectsWith } from "../support/errors.js";
import { assertNear, forSeeds, type Random } from "../support/random.js";
import { columnMajor, mesh, transformed, truth, view } from "../support/scene.js";

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

test("an object under the camera is where the mesh was found", () => {
  forSeeds(10, (random, seed) => {
    const pose = random.pose();
    const object = place(new Group(), random);
    place(new PerspectiveCamera(), random, true).add(object);
    applyToObject3D(object, pose);
    assertNear(object.matrix.elements, toFrame(pose, "opengl").matrix, seed);
    assertNear(transformFromObject3D(object).matrix, columnMajor(pose), seed);
    applyToObject3D(object, pose, { frame: "opencv" });
    assertNear(object.matrix.elements, columnMajor(pose), seed);
    assertNear(transformFromObject3D(object, { frame: "opencv" }).matrix, columnMajor(pose), seed);
  });
});

test("an object anywhere in a scene is where the camera, anywhere else, saw it", () => {
  forSeeds(20, (random, seed) => {
    const pose = random.pose();
    const [scene, table] = [new Scene(), place(new Group(), random)];
    const [camera, object] = [place(new PerspectiveCamera(), random, true), place(new Mesh(), random)];
    const rig = place(new Group(), random).add(camera);
    scene.add(table, rig);
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

test("a mesh from three.js aligns, and the object goes where it was found", async () => {
  const aligner = await createAligner();
  const object = new Group().add(new Mesh(geometryOf()));
  // Whatever the object's own transform is, it is the one that is set.
  object.position.set(5, 6, 7);
  object.scale.setScalar(3);
  const { width, height, depth, mask, camera } = view;
  const input = { depth, width, height, mask, camera, mesh: meshInputFromThree(object) };
  assert.deepEqual(input.mesh, mesh);
  const result = await aligner.align(input);
  applyToObject3D(object, result);
  object.position.x += 0.004;
  const again = await aligner.align(input, { initial: transformFromObject3D(object), search: "local" });
  const { errors } = await aligner.evaluate(input, again, { truth });
  assert.ok(errors !== null && errors.scaleError < 0.05 && errors.rotationErrorDeg < 10, JSON.stringify(errors));
});

test("meshes below an object come in its frame, mirrored and shared ones and instances too", () => {
  forSeeds(10, (random, seed) => {
    const box = new BoxGeometry(1, 2, 3);
    const [root, middle, leaf] = [place(new Group(), random), place(new Group(), random), place(new Mesh(box), random)];
    leaf.scale.set(random.between(0.5, 2), -random.between(0.5, 2), random.between(0.5, 2));
    const instances = place(new InstancedMesh(box, undefined, 2), random);
    instances.setMatrixAt(0, new Matrix4().makeTranslation(1, 2, 3));
    instances.setMatrixAt(1, new Matrix4().makeScale(1, 2, 1));
    root.add(middle.add(leaf), instances, new Group());
    const parent = place(new Group(), random).add(root);
    parent.updateMatrixWorld(true);
    const local = root.matrixWorld.clone().invert();
    const placedBy = [
      local.clone().multiply(leaf.matrixWorld),
      ...[new Matrix4().makeTranslation(1, 2, 3), new Matrix4().makeScale(1, 2, 1)].map((instance) =>
        local.clone().multiply(instances.matrixWorld).multiply(instance),
      ),
    ];
    const corners = Array.from({ length: 24 }, (_, i) =>
      new Vector3().fromBufferAttribute(box.getAttribute("position"), i),
    );
    const expected = placedBy.flatMap((m) => corners.flatMap((corner) => corner.clone().applyMatrix4(m).toArray()));
    const found = meshInputFromThree(root);
    assertNear(found.positions, expected, seed, 1e-5);
    assert.equal(found.indices.length, 3 * 36);
    const world = meshInputFromThree(root, { frame: "world" });
    const inWorld = new Vector3().fromArray(world.positions, 0).applyMatrix4(local).toArray();
    assertNear(inWorld, expected.slice(0, 3), seed, 1e-4);
    // Every triangle's front stays outside: the volume that they enclose is positive.
    for (const part of [0, 1, 2]) {
      let volume = 0;
      for (let i = 36 * part; i < 36 * (part + 1); i += 3) {
        const [a, b, c] = [0, 1, 2].map((k) =>
          new Vector3().fromArray(found.positions, 3 * (found.indices[i + k] ?? 0)),
        );
        if (a && b && c) volume += a.dot(b.clone().cross(c)) / 6;
      }
      assert.ok(volume > 0, `${seed}: part ${part} is inside out`);
    }
  });
});

test("geometries: as they are, without indices, interleaved, normalised", () => {
  assert.deepEqual(meshInputFromThree(geometryOf()), mesh);
  const soup = geometryOf().toNonIndexed();
  assert.deepEqual([...meshInputFromThree(soup).indices.subarray(0, 6)], [0, 1, 2, 3, 4, 5]);
  const interleaved = new BufferGeometry();
  const numbers = new InterleavedBuffer(Float32Array.of(9, 0, 0, 0, 9, 1, 0, 0, 9, 0, 1, 0), 4);
  interleaved.setAttribute("position", new InterleavedBufferAttribute(numbers, 3, 1));
  assert.deepEqual([...meshInputFromThree(interleaved).positions], [0, 0, 0, 1, 0, 0, 0, 1, 0]);
  const quantised = new BufferGeometry();
  quantised.setAttribute("position", new BufferAttribute(Int16Array.of(0, 0, 0, 32767, 0, 0, 0, -32767, 0), 3, true));
  assert.deepEqual([...meshInputFromThree(quantised).positions], [0, 0, 0, 1, 0, 0, 0, -1, 0]);
});

test("a pinhole camera in three.js sees every point at its pixel, in WebGL and WebGPU", () => {
  forSeeds(30, (random, seed) => {
    const lens = { width: random.whole(100, 900), height: random.whole(100, 900), near: 0.1, far: 20 };
    const pinhole = {
      ...{ fx: random.between(200, 900), fy: random.between(200, 900) },
      ...{ cx: random.between(0, lens.width), cy: random.between(0, lens.height) },
    };
    const camera = new PerspectiveCamera(20, 3, 1, 2);
    applyPinhole(camera, pinhole, lens);
    const { projectionMatrix, fov, aspect, near, far } = cameraFromPinhole(pinhole, lens);
    assertNear(projectionMatrix, camera.projectionMatrix.elements, seed);
    assert.deepEqual({ fov, aspect, near, far }, { fov: camera.fov, aspect: camera.aspect, near: 0.1, far: 20 });
    for (const system of [camera.coordinateSystem, WebGPUCoordinateSystem]) {
      camera.coordinateSystem = system as typeof camera.coordinateSystem;
      camera.updateProjectionMatrix();
      const [x, y, z] = [random.between(-1, 1), random.between(-1, 1), random.between(0.5, 9)];
      // OpenGL's camera frame, then from clip space to pixels, whose centres are at whole numbers.
      const clip = new Vector3(x, -y, -z).applyMatrix4(camera.projectionMatrix);
      const pixel = [((clip.x + 1) / 2) * lens.width - 0.5, ((1 - clip.y) / 2) * lens.height - 0.5];
      const expected = [(pinhole.fx * x) / z + pinhole.cx, (pinhole.fy * y) / z + pinhole.cy];
      assertNear(pixel, expected, `${seed}, ${system}`, 1e-6);
    }
  });
});

test("wrong objects and cameras are refused", async () => {
  await rejectsWith(() => meshInputFromThree(new Group()), "EMPTY_MESH source", /no triangle/);
  await rejectsWith(() => meshInputFromThree({} as never), "INVALID_ARGUMENT source", /BufferGeometry or an Object3D/);
  const flat = new Group().add(new Mesh(new BoxGeometry()));
  flat.scale.set(1, 0, 1);
  await rejectsWith(() => meshInputFromThree(flat), "INVALID_TRANSFORM source.matrixWorld", /other than 0/);
  const stretched = new Mesh();
  stretched.scale.set(1, 2, 1);
  await rejectsWith(() => transformFromObject3D(stretched), "INVALID_TRANSFORM transform", /uniform scale/);
  const pose = { scale: 1, rotation: new Quaternion().toArray(), translation: [0, 0, 1] };
  await rejectsWith(
    () => applyToObject3D(new Group(), pose, { frame: "ros" as never }),
    "INVALID_OPTION options.frame",
    /"opencv" or "opengl"/,
  );
  await rejectsWith(
    () => cameraFromPinhole(view.camera, { ...view, near: 2, far: 1 }),
    "INVALID_ARGUMENT lens.far",
    /beyond near/,
  );
});
