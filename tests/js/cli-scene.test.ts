/** `sim3align scene`: scene folders, images of BOP and outputs of SAM 3D; JSON, tables, GLB and files of simulators. */
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { Quaternion, Vector3 } from "three";
import { writeBop } from "../support/bop.js";
import { files, folder, read, refusesUsage, results, run, succeeds, writeCase } from "../support/command-line.js";
import { png } from "../support/files.js";
import { assertValid } from "../support/gltf-validator.js";
import { assertNear } from "../support/random.js";
import { sam3dFiles } from "../support/sam3d.js";
import { masks, plane, poses, standingGlb, standingMesh, tableFiles, tableView } from "../support/table.js";

const { width, height, camera } = tableView;
const bytes = (path: string) => new Uint8Array(readFileSync(join(folder, path)));
const names = ["thing-0", "thing-1", "thing-2"];
writeCase("table", tableFiles());
writeFileSync(join(folder, "plane.json"), JSON.stringify(plane));

test("a scene folder gives JSON, a table, lengths in the proportions that were found, and a GLB; a record is resumed", async () => {
  const flags = "--quality fast --proportions axes --json s.json --csv s.csv --jsonl s.jsonl --scene-glb s.glb";
  const { stdout } = succeeds(`scene table ${flags}`);
  assert.match(stdout, /table: support n = .*thing-0.*support.*thing-2/s);
  const { table } = results("s.json");
  assert.deepEqual(table.inputs["objects/thing-0/mask.png"], { as: "mask", reading: "values of 1" });
  const lines = stdout.split("\n");
  for (const [i, pose] of poses.entries()) {
    const { name, scale, matrix, rotation, confidence, errors, contact, proportions } = table.objects[i];
    assert.ok(Math.abs(scale / pose.scale - 1) < 0.05 && errors.scaleError < 0.05 && confidence >= 0);
    const rests = i < 2 ? "support" : null;
    assert.deepEqual([name, matrix.length, rotation.length, contact.restsOn], [names[i], 16, 4, rests]);
    const sides = [0, 1, 2].map((k) => {
      const [sizeMm, percent] = [1000 * proportions.sizeM[k], 100 * proportions.uncertainty[k]];
      return `${"xyz"[k]} ${sizeMm.toFixed(1)} mm ± ${percent.toFixed(1)} %`;
    });
    const below = lines[lines.findIndex((line) => line.startsWith(`thing-${i}`)) + 1];
    assert.equal(below?.trim(), `in proportion  ${sides.join(", ")}`);
  }
  assert.ok(Math.abs(table.support.d - plane.d) < 0.003 && table.support.normal.length === 3);
  assert.equal((await assertValid(bytes("s.glb"))).totalTriangleCount, standingMesh.indices.length + 2);
  assert.deepEqual(read("s.csv").match(/(?<=^table\/)[\w-]+/gm), names);
  assert.match(succeeds(`scene table ${flags.replace(" --scene-glb s.glb", "")} --resume`).stderr, /resumed: 1 of 1/);
});

test("the support and one scale for all objects are options; a scene that cannot be read fails alone", () => {
  writeCase("no-depth", { "camera.json": camera });
  const { status, stdout } = run("scene no-depth table --quality fast --support none --scale 0.06 --json f.json");
  assert.equal(status, 1);
  assert.match(stdout, /no-depth: FILE_NOT_FOUND/);
  const { "no-depth": failed, table } = results("f.json");
  assert.deepEqual([failed.error.code, table.support], ["FILE_NOT_FOUND", null]);
  for (const { name, scale } of table.objects) assert.ok(Math.abs(scale - 0.06) < 1e-12, name);
  succeeds("scene table --quality fast --support plane.json --json p.json");
  assert.equal(results("p.json").table.support.confidence, 1);
});

test("an image of BOP is a scene", () => {
  writeBop(join(folder, "bop", "tudl"));
  for (const [flag, image, names] of [
    ["", "000000", "1-0,2-1"],
    ["--image-id 7", "000007", "2-0,3-1,2-2,2-3"],
  ]) {
    succeeds(`scene bop/tudl/test/000001 --quality fast --json b.json ${flag}`);
    const { objects } = results("b.json")[`000001/${image}`];
    assert.equal(objects.map(({ name }: { name: string }) => name).join(), names);
    for (const { name, errors } of objects) assert.ok(errors.scaleError < 0.05, name);
  }
});

test("an output of SAM 3D is a scene; a scale goes before its placements, and simulators need metres", async () => {
  const objects = poses.slice(0, 2).map((pose, i) => ({
    ...{ name: `thing-${i}`, mask: png(masks[i] as Uint8Array, width, height), glb: standingGlb, pose },
  }));
  writeCase("sam3d", sam3dFiles(tableView, objects));
  succeeds("scene --sam3d sam3d --depth-kind metric --quality fast --scene-glb o.glb --json o.json");
  for (const [i, { pose }] of objects.entries()) {
    const found = results("o.json").sam3d.objects[i];
    assert.ok(Math.abs(found.scale / pose.scale - 1) < 0.05, `${found.scale}`);
    assertNear(found.translation, pose.translation, "place", 0.01);
  }
  await assertValid(bytes("o.glb"));
  const scale = poses[0]?.scale ?? 1;
  succeeds(`scene --sam3d sam3d --quality fast --scale ${1.01 * scale},${2 * scale} --json g.json`);
  const unit = { metres: null, source: "scale-invariant, a point map with x left, y up, z forward", isAssumed: false };
  assert.deepEqual(results("g.json").sam3d.depthUnit, unit);
  refusesUsage({ "scene --sam3d sam3d --usd w.usda": /--depth-kind metric/ });
});

test("upright objects of a scene stand in the files of simulators", async () => {
  const simulators = "--mjcf mujoco --urdf urdf --usd scene.usda --density 250 --parts 2";
  const upright = `scene table --quality fast --no-rest --upright --scene-glb straight.glb ${simulators}`;
  const { stdout } = succeeds(upright);
  assert.match(stdout, /thing_0: [\d.]+ kg, (1 convex part|\d convex parts), free, where it was found/);
  assert.match(stdout, /thing_2: .*, fixed where it was found, as it rests on nothing in the scene/);
  await assertValid(bytes("straight.glb"));
  // Bodies turn about the vertical only.
  const bodies = [...read(join("mujoco", "scene.xml")).matchAll(/name="thing_\d_found" size="7" data="([^"]+)"/g)];
  assert.equal(bodies.length, 3);
  for (const [, data = ""] of bodies) {
    const [, , , w = 0, x = 0, y = 0, z = 0] = data.split(" ").map(Number);
    assertNear(new Vector3(0, 0, 1).applyQuaternion(new Quaternion(x, y, z, w)).toArray(), [0, 0, 1], "up", 1e-5);
  }
  assert.match(read("scene.usda"), /upAxis = "Z"/);
  assert.match(read(join("urdf", "scene.json")), /thing_0/);
});

test("exported cameras are those of the result, whatever form the camera has", () => {
  const { fx, fy, cx, cy } = camera;
  const cameras: Record<string, object> = {
    "four numbers": { fx, fy, cx, cy },
    "in image sizes": { K: [fx / width, 0, (cx + 0.5) / width, 0, fy / height, (cy + 0.5) / height, 0, 0, 1] },
    "a field of view": { fovYDeg: (2 * Math.atan(height / (2 * fy)) * 180) / Math.PI },
  };
  for (const [what, form] of Object.entries(cameras)) {
    writeCase("seen", { ...tableFiles(1), "camera.json": form });
    succeeds("scene seen --quality fast --no-rest --parts 1 --scene-glb seen.glb --mjcf in-mujoco --urdf in-urdf");
    const [, yfov] = /"yfov":([\d.]+)/.exec(read("seen.glb")) ?? [];
    const [, resolution, focal = ""] =
      /resolution="([^"]+)".*focalpixel="([^"]+)"/.exec(read(join("in-mujoco", "scene.xml"))) ?? [];
    assertNear([Number(yfov)], [2 * Math.atan(height / (2 * fy))], what, 1e-6);
    assert.equal(resolution, `${width} ${height}`);
    assertNear(focal.split(" ").map(Number), [fx, fy], what, 1e-3);
    const written = JSON.parse(read(join("in-urdf", "scene.json"))).camera;
    assertNear([written.fy, written.cx, written.cy], [fy, cx, cy], what, 1e-3);
  }
});

test("files that other programs wrote are not written over", () => {
  writeCase("blob", files);
  writeCase("one", tableFiles(1));
  const flags: Record<string, string> = {
    "--scene-glb": "own.glb",
    "--parts 1 --mjcf": "own/scene.xml",
    "--mjcf": "bowls/meshes/bowl.obj",
    "--parts 1 --urdf": "own/load.py",
    "--parts 1 --usd": "own.usda",
    "--overlay": "own/blob.png",
    "--glb": "own/blob.glb",
  };
  for (const [flag, file] of Object.entries(flags)) {
    writeCase(".", { [file]: "a day's work" });
    const [argument, command] = [file.split("/")[0], file.includes("blob") ? "align blob" : "scene one"];
    const { status, stderr } = run(`${command} --quality fast ${flag} ${argument}`);
    // The files of a scene are known before its alignment.
    assert.ok(status === 2 || (status === 1 && command.startsWith("align")), `${flag}: ${status}`);
    assert.match(stderr, /not written by/, flag);
    assert.equal(read(file), "a day's work");
  }
});
