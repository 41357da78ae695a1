/** `sim3align scene`: scene folders and images of BOP, JSON, GLB and failures. */
import assert from "node:assert/strict";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { plyText } from "../support/bop-dataset.js";
import { folder, refusesUsage, results, run, succeeds, writeCase } from "../support/command-line.js";
import { png } from "../support/files.js";
import { assertValid } from "../support/gltf-validator.js";
import { rotationRows } from "../support/scene.js";
import { masks, plane, poses, standingMesh, tableFiles, tableView } from "../support/table.js";

const { width, height, depth, camera } = tableView;
writeCase("table", tableFiles());

test("a scene folder gives JSON, a table and a GLB", async () => {
  const { stdout } = succeeds("scene table --quality fast --json s.json --scene-glb s.glb");
  assert.match(stdout, /table: support n = .*thing-0.*support.*thing-2/s);
  const { table } = results("s.json");
  assert.deepEqual(Object.keys(table.objects), ["thing-0", "thing-1", "thing-2"]);
  for (const [i, pose] of poses.entries()) {
    const object = table.objects[`thing-${i}`];
    assert.ok(Math.abs(object.scale / pose.scale - 1) < 0.05);
    assert.equal(object.matrix.length, 16);
    assert.equal(object.rotation.length, 3);
    assert.ok(object.confidence >= 0 && object.errors.scaleError < 0.05);
    assert.equal(object.contact.restsOn, i < 2 ? "support" : null);
  }
  assert.ok(Math.abs(table.support.d - plane.d) < 0.003);
  assert.equal(table.support.normal.length, 3);
  const { totalTriangleCount } = await assertValid(new Uint8Array(readFileSync(join(folder, "s.glb"))));
  assert.equal(totalTriangleCount, standingMesh.indices.length + 2);
});

test("lengths in the proportions found are below the row of each object", () => {
  const { stdout } = succeeds("scene table --quality fast --proportions axes --json sizes.json");
  for (const name of ["thing-0", "thing-1", "thing-2"]) {
    const { sizeM, uncertainty } = results("sizes.json").table.objects[name].proportions;
    const sides = [0, 1, 2].map(
      (k) => `${"xyz"[k]} ${(1000 * sizeM[k]).toFixed(1)} mm ± ${(100 * uncertainty[k]).toFixed(1)} %`,
    );
    const [, own] = stdout.split("\n").slice(stdout.split("\n").findIndex((line) => line.startsWith(name)));
    assert.equal(own?.trim(), `in proportion  ${sides.join(", ")}`);
  }
});

test("the support is given, or there is none", () => {
  writeFileSync(join(folder, "plane.json"), JSON.stringify(plane));
  succeeds("scene table --quality fast --support none --json n.json");
  assert.equal(results("n.json").table.support, null);
  succeeds("scene table --quality fast --support plane.json --json p.json");
  assert.equal(results("p.json").table.support.confidence, 1);
});

test("an image of BOP is a scene", () => {
  const scene = join("bop", "test", "000007");
  const millimetres = Uint16Array.from(depth, (z) => Math.round(10_000 * z));
  writeCase(scene, {
    "scene_camera.json": {
      "3": { cam_K: [camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1], depth_scale: 0.1 },
    },
    "scene_gt.json": {
      "3": poses.slice(0, 2).map((pose, i) => ({
        obj_id: i + 1,
        cam_R_m2c: rotationRows(pose.rotation).flat(),
        cam_t_m2c: pose.translation.map((x) => 1000 * x),
      })),
    },
  });
  for (const name of ["depth", "mask_visib"]) mkdirSync(join(folder, scene, name), { recursive: true });
  writeFileSync(join(folder, scene, "depth", "000003.png"), png(millimetres, width, height));
  for (const i of [0, 1]) {
    writeFileSync(
      join(folder, scene, "mask_visib", `000003_00000${i}.png`),
      png(masks[i] as Uint8Array, width, height),
    );
  }
  mkdirSync(join(folder, "bop", "models"), { recursive: true });
  for (const [i, pose] of poses.slice(0, 2).entries()) {
    writeFileSync(
      join(folder, "bop", "models", `obj_00000${i + 1}.ply`),
      plyText({ ...standingMesh, positions: standingMesh.positions.map((x) => 1000 * pose.scale * x) }),
    );
  }
  succeeds("scene", scene, "--quality", "fast", "--json", "b.json");
  const { objects } = results("b.json")["000007/000003"];
  assert.deepEqual(Object.keys(objects), ["1-0", "2-1"]);
  for (const object of Object.values<{ errors: { scaleError: number } }>(objects)) {
    assert.ok(object.errors.scaleError < 0.05);
  }
});

test("a scene that cannot be read fails alone", () => {
  writeCase("no-depth", { "camera.json": camera });
  const { status, stdout } = run("scene no-depth table --quality fast --json f.json");
  assert.equal(status, 1);
  assert.match(stdout, /no-depth: FILE_NOT_FOUND/);
  const written = results("f.json");
  assert.equal(written["no-depth"].error.code, "FILE_NOT_FOUND");
  assert.equal(Object.keys(written.table.objects).length, 3);
  refusesUsage({ "scene table no-depth --scene-glb two.glb": /./ });
});
