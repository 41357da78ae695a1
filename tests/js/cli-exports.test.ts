/** What the command line exports of a mesh that is stretched, or that is to stand upright. */
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { type BufferGeometry, Mesh, Quaternion, Vector3 } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { files, folder, read, results, succeeds, writeCase } from "../support/command-line.js";
import { glb } from "../support/files.js";
import { assertValid } from "../support/gltf-validator.js";
import { assertNear } from "../support/random.js";
import { mesh } from "../support/scene.js";
import { tableFiles } from "../support/table.js";

const narrow = { ...mesh, positions: mesh.positions.map((x, i) => (i % 3 === 0 ? 0.9 * x : x)) };
writeCase("table", tableFiles());
writeCase("narrow", { ...files, "mesh.glb": glb(narrow) });

/** The vertices of a GLB in its world, and in the frame of the node whose name this is. */
async function vertices(path: string, frame?: string): Promise<Vector3[]> {
  const bytes = Uint8Array.from(readFileSync(join(folder, path)));
  const { scene } = await new GLTFLoader().parseAsync(bytes.buffer, "");
  scene.updateMatrixWorld(true);
  const found: Vector3[] = [];
  const into = frame === undefined ? undefined : scene.getObjectByName(frame)?.matrixWorld.clone().invert();
  scene.traverse((child) => {
    if (!(child instanceof Mesh) || child.name === "support") return;
    const { position } = (child.geometry as BufferGeometry).attributes;
    for (let i = 0; i < (position?.count ?? 0); i++) {
      const vertex = new Vector3().fromBufferAttribute(position as never, i).applyMatrix4(child.matrixWorld);
      found.push(into === undefined ? vertex : vertex.applyMatrix4(into));
    }
  });
  return found;
}

const flat = (points: readonly Vector3[]) => points.flatMap((point) => point.toArray());

test("files of a case hold the mesh in the proportions that were found, and its lengths are printed", async () => {
  const flags = "--quality fast --proportions axes --json p.json";
  const { stdout } = succeeds(`align narrow ${flags} --glb posed`);
  const { proportions } = results("p.json").narrow;
  assert.ok(proportions.stretch[0][0] > 1.02, `${proportions.stretch}`);
  const sizes = proportions.sizeM.map((size: number) => (1000 * size).toFixed(1));
  assert.match(stdout, new RegExp(`in proportion +x ${sizes[0]} mm ± .*y ${sizes[1]} mm ± .*z ${sizes[2]} mm`));
  const posed = await vertices(join("posed", "narrow.glb"));
  // The stretched mesh by its similarity, in the frame of a glTF camera.
  const [a, b, c] = proportions.stretch as [number[], number[], number[]];
  const m = proportions.matrix as number[];
  const expected = posed.map((_, i) => {
    const p = [0, 1, 2].map((k) => narrow.positions[3 * i + k] ?? 0);
    const q = [a, b, c].map((row) => row.reduce((sum, s, k) => sum + s * (p[k] ?? 0), 0));
    const at = [0, 1, 2].map((k) =>
      [0, 1, 2].reduce((sum, j) => sum + (m[4 * j + k] ?? 0) * (q[j] ?? 0), m[12 + k] ?? 0),
    );
    return new Vector3(at[0], -(at[1] ?? 0), -(at[2] ?? 0));
  });
  assertNear(flat(posed), flat(expected), "vertices", 1e-5);
  succeeds(`align narrow ${flags} --glb upright --upright`);
  assertNear(flat(await vertices(join("upright", "narrow.glb"))), flat(posed), "upright, every vertex stays", 1e-5);
});

test("upright objects of a scene stand in their own frames, and stay where they are", async () => {
  const flags = "--quality fast --no-rest";
  succeeds(`scene table ${flags} --scene-glb own.glb`);
  succeeds(`scene table ${flags} --upright --scene-glb straight.glb --mjcf mujoco --urdf urdf --usd scene.usda`);
  await assertValid(new Uint8Array(readFileSync(join(folder, "straight.glb"))));
  const [own, straight] = [await vertices("own.glb"), await vertices("straight.glb")];
  const shift = (straight[0] as Vector3).clone().sub(own[0] as Vector3);
  assert.ok(Math.abs(shift.y) < 1e-5, "the origin of the scene moves along the ground only");
  assertNear(flat(straight), flat(own.map((point) => point.clone().add(shift))), "the scene", 1e-5);
  const local = await vertices("straight.glb", "thing-0");
  // Of all objects, in the frame of the first: the first has its bottom at 0.
  const count = local.length / 3;
  const height = Math.min(...local.slice(0, count).map((point) => point.y));
  assert.ok(Math.abs(height) < 1e-4, `${height}`);
  // Bodies turn about the vertical only.
  const poses = [...read(join("mujoco", "scene.xml")).matchAll(/name="thing_\d_found" size="7" data="([^"]+)"/g)];
  assert.equal(poses.length, 3);
  for (const [, data = ""] of poses) {
    const [, , , w = 0, x = 0, y = 0, z = 0] = data.split(" ").map(Number);
    const up = new Vector3(0, 0, 1).applyQuaternion(new Quaternion(x, y, z, w));
    assertNear(up.toArray(), [0, 0, 1], "up", 1e-5);
  }
  assert.match(read("scene.usda"), /upAxis = "Z"/);
  assert.match(read(join("urdf", "scene.json")), /thing_0/);
});
