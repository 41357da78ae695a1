/** The command line with one photo: depth as models guess it, and no camera file. */
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { files, folder, read, refusesUsage, results, run, succeeds, writeCase } from "../support/command-line.js";
import { greyJpeg, tiff } from "../support/exif.js";
import { type Files, glb, npy, viewFiles } from "../support/files.js";
import { assertValid } from "../support/gltf-validator.js";
import { frameAt, turnBetween } from "../support/rig.js";
import { mesh, poseJson, truth, type View, view } from "../support/scene.js";
import { poses, tableFiles, tableView } from "../support/table.js";
import { deflated, zip } from "../support/zip.js";

const { width, height, camera } = view;
const { "camera.json": _, ...uncalibrated } = files;
const gt = poseJson(truth);

/** What a model of relative depth returns. */
const disparity = ({ depth, width, height }: Pick<View, "depth" | "width" | "height">) =>
  npy(
    depth.map((z) => (z > 0 ? 2 / z + 0.3 : Number.NaN)),
    height,
    width,
  );

const relative = ["--depth-kind", "affine-invariant-disparity"];
const quick = ["--quality", "fast"];

/** A photo of the scene's camera: 65 mm on full frame are 300 pixels. */
const photo = greyJpeg(tiff({ make: "Maker" }, { focal35: 65, pixelX: width, pixelY: height }, true), width, height);

/** A photo of the camera of the table: 37 mm are 171 pixels. */
const tablePhoto = greyJpeg(tiff({}, { focal35: 37, pixelX: width, pixelY: height }, false), width, height);

/** The largest extent of the mesh at the true pose, metres. */
const extentM = Math.max(
  ...[0, 1, 2].map((axis) => {
    const side = mesh.positions.filter((_, i) => i % 3 === axis);
    return truth.scale * (side.reduce((a, b) => Math.max(a, b)) - side.reduce((a, b) => Math.min(a, b)));
  }),
);
const known = ["--known-extent", String(extentM)];

writeCase("metric", { ...files, "gt.json": gt });
writeCase("taken", { ...uncalibrated, "rgb.jpg": photo });
writeFileSync(join(folder, "d.npz"), zip([deflated("depth.npy", files["depth.npy"] as Uint8Array)]));
writeCase("alone", uncalibrated);
writeCase("relative", { ...files, "depth.npy": disparity(view), "gt.json": gt });
const { "depth.npy": __, ...withoutDepth } = uncalibrated;
writeCase("model", { ...withoutDepth, "depth.npz": zip([deflated("depth.npy", disparity(view))]), "rgb.jpg": photo });

/** Nothing that is printed may claim a length in metres. */
function hasNoMetres(printed: string): void {
  assert.doesNotMatch(printed, /\d (m|cm|mm)\b/);
  assert.equal(printed.match(/Lengths have no unit.*--known-extent/g)?.length, 1, printed);
}

test("the photo gives the focal length: as an argument, by --image, and in a case folder", () => {
  const parts = ["--depth", "taken/depth.npy", "--mask", "taken/mask.png", "--mesh", "taken/mesh.glb", ...quick];
  const [, , ...others] = parts;
  const { stdout } = succeeds("align", "taken/rgb.jpg", "--depth", "d.npz", ...others, "--json", "argument.json");
  assert.match(stdout, /depth unit +metres \(float values, assumed\)\n/);
  assert.match(stdout, /focal length +\d{3}\.\d px ± \d\.\d %, EXIF: 65 mm \(35 mm equivalent\)\n/);
  const { mesh: found } = results("argument.json");
  const { cameraSource, depthCalibration, depthUnit, warnings } = found;
  assert.match(cameraSource, /^EXIF: /);
  assert.equal(depthUnit, "metres (float values, assumed)");
  assert.deepEqual([depthCalibration.depthKind, depthCalibration.isMetric, warnings], ["metric", true, []]);
  assert.ok(Math.abs(depthCalibration.camera.fx / camera.fx - 1) < 0.05, `${depthCalibration.camera.fx}`);
  assert.ok(Math.abs(found.scale / truth.scale - 1) < 0.05 && turnBetween(found.quaternion, truth.rotation) < 5);
  succeeds("align", ...parts, "--image", "taken/rgb.jpg", "--json", "flag.json");
  succeeds("align taken --json folder.json", ...quick);
  for (const other of [results("flag.json").mesh, results("folder.json").taken]) {
    assert.deepEqual([other.matrix, other.depthCalibration], [found.matrix, depthCalibration]);
  }
});

test("without photo and camera, the focal length is estimated, with a warning", () => {
  const { stdout } = succeeds("align alone --json alone.json", ...quick);
  assert.match(stdout, /focal length +\d+\.\d px ± \d+\.\d %, estimate\n/);
  assert.match(stdout, /FOCAL_LENGTH_UNKNOWN/);
  assert.equal(results("alone.json").alone.depthCalibration.isFocalEstimated, true);
});

test("relative depth has no unit, and none is printed", () => {
  for (const name of ["relative", "model"]) {
    const { stdout } = succeeds(`align ${name} --json r.json`, ...relative, ...quick);
    hasNoMetres(stdout.replace(/EXIF: .*/, ""));
    assert.match(stdout, /scale s +[\d.]+ units per mesh unit\n/);
    assert.match(stdout, /depth +affine-invariant-disparity, z = [\d.]+ \/ \(d [−+] [\d.]+\), ± [\d.]+ % of the/);
    const { [name]: entry } = results("r.json");
    assert.equal(entry.depthCalibration.isMetric, false);
    assert.equal("errors" in entry, false, "errors against metres cannot be measured");
    assert.ok(turnBetween(entry.quaternion, truth.rotation) < 6);
  }
  const { stdout } = succeeds("align relative --preset paper --seed 1", ...relative);
  hasNoMetres(stdout);
});

test("--known-extent makes relative depth metric", () => {
  const { stdout } = succeeds("align relative --json k.json", ...relative, ...quick, ...known);
  assert.match(stdout, /scale s +[\d.]+ m per mesh unit\n/);
  assert.doesNotMatch(stdout, /have no unit/);
  const { depthCalibration, errors, scale, translation } = results("k.json").relative;
  assert.equal(depthCalibration.isMetric, true);
  assert.ok(Math.abs(scale / truth.scale - 1) < 1e-6);
  const [x, y, z] = truth.translation;
  const off = Math.hypot(translation[0] - x, translation[1] - y, translation[2] - z);
  assert.ok(off < 0.05 * z, `${off}`);
  // They are measured in the corrected depth map.
  assert.ok(errors.rotationErrorDeg < 5 && errors.scaleError < 1e-6, JSON.stringify(errors));
});

test("a batch of both kinds of camera: columns of metres are empty, the note is said once, and it resumes", () => {
  writeFileSync(join(folder, "list"), "relative\nmodel\n");
  const batch = ["--list", "list", ...relative, ...quick, "--jsonl", "b.jsonl", "--csv", "b.csv", "--workers", "1"];
  const { stdout } = succeeds("align", ...batch, "--report", "report");
  hasNoMetres(stdout);
  assert.match(stdout, /^case .*Chamfer mm.*Δtrans mm/);
  assert.match(stdout, /^model .* – /m);
  const table = () => {
    const [head = "", ...rows] = read("b.csv").trim().split("\n");
    const columns = head.split(",");
    return rows.map((row) => Object.fromEntries(row.split(",").map((cell, i) => [columns[i], cell])));
  };
  for (const row of table()) {
    assert.deepEqual([row.isMetric, row.txM, row.chamferMm, row.depthMaeMm], ["false", "", "", ""]);
    assert.ok(Number(row.scale) > 0 && Number(row.iou) > 0.9 && Number(row.timeMs) > 0);
  }
  const rows = read("report/rows.js");
  assert.equal(rows.match(/"isMetric":false/g)?.length, 2);
  const [line] = read("b.jsonl").split("\n");
  writeFileSync(join(folder, "b.jsonl"), `${line}\n`);
  const again = succeeds("align", ...batch, "--resume");
  assert.match(again.stderr, /resumed: 1 of 2/);
  assert.equal(table().length, 2);
  hasNoMetres(again.stdout);
});

test("pictures and posed meshes are in the unit of the pose", async () => {
  const drawn = ["--overlay", "overlay", "--glb", "posed", "--report", "page"];
  const { stderr } = succeeds("align relative", ...relative, ...quick, ...drawn, "--json", "p.json");
  assert.doesNotMatch(stderr, /no pictures/);
  const { metrics, scale } = results("p.json").relative;
  const details = read("page/cases/relative/details.js");
  // A fiftieth of what is visible of the mesh, here in thousandths of the unit.
  const { limitMm } = JSON.parse(details.slice(details.indexOf("{"), -2)) as { limitMm: number };
  assert.ok(Math.abs(limitMm / ((1000 * scale * extentM) / truth.scale / 50) - 1) < 0.5, `${limitMm}`);
  assert.ok(metrics.iou > 0.9);
  assert.ok(readFileSync(join(folder, "posed", "relative.glb")).length > 1000);
});

/** Writes frames at these angles, with a mask in the first ones. */
function writeFrames(name: string, angles: readonly number[], masks: number): void {
  const written: Files = { "mesh.glb": glb(mesh) };
  for (const [k, angle] of angles.entries()) {
    const { frame } = frameAt(angle);
    const { "mask.png": mask, "camera.json": own } = viewFiles(frame);
    const parts = { "depth.npy": disparity(frame), "camera.json": own, ...(k < masks ? { "mask.png": mask } : {}) };
    for (const [file, content] of Object.entries(parts)) written[`frame_${k}/${file}`] = content;
  }
  writeCase(name, written);
}

test("several views of relative depth", () => {
  writeFrames("views", [0, 25], 2);
  const { stdout } = succeeds("align views --json views.json --csv views.csv", ...relative, ...quick);
  hasNoMetres(stdout);
  assert.equal(stdout.match(/depth: affine-invariant-disparity/g)?.length, 2);
  assert.equal(results("views.json").views.frames.frame_1.depthCalibration.isMetric, false);
  assert.match(read("views.csv"), /\nviews,,[\d.]+,\d+,false,/);
});

test("a video of relative depth", () => {
  writeFrames("video", [0, 3, 6], 1);
  const { stdout } = succeeds("track video --json video.json", ...relative);
  hasNoMetres(stdout);
  assert.match(stdout, /frame_2 +tracking.*\n +depth unit +none.*\n +depth +affine-invariant-disparity, z = /);
  const { video } = results("video.json");
  assert.equal(video.frames.frame_2.depthCalibration.isMetric, false);
  for (const [k, angle] of [0, 3, 6].entries()) {
    const { state, quaternion } = video.frames[`frame_${k}`];
    assert.equal(state, "tracking");
    assert.ok(turnBetween(quaternion, frameAt(angle).pose.rotation) < 8, `frame ${k}`);
  }
  assert.match(succeeds("track video", ...relative, ...known).stdout, /depth +affine-invariant-disparity/);
});

test("a scene of relative depth without a camera file", async () => {
  const { "camera.json": _, ...scene } = tableFiles();
  writeCase("table", { ...scene, "depth.npy": disparity(tableView), "rgb.jpg": tablePhoto });
  const flags = [...relative, ...quick, "--json", "s.json", "--csv", "s.csv", "--scene-glb", "s.glb"];
  const { stdout } = succeeds("scene table", ...flags);
  hasNoMetres(stdout.replace(/EXIF: .*/, ""));
  assert.match(stdout, /focal length +\d+\.\d px ± .*EXIF: 37 mm/);
  const { table } = results("s.json");
  assert.equal(table.depthCalibration.isMetric, false);
  assert.match(table.cameraSource, /^EXIF/);
  for (const [i, pose] of poses.entries()) {
    const object = table.objects[`thing-${i}`];
    assert.ok(turnBetween(object.quaternion, pose.rotation) < 8, `object ${i}`);
    assert.equal("errors" in object, false);
  }
  assert.equal(read("s.csv").match(/,false,/g)?.length, 3);
  await assertValid(new Uint8Array(readFileSync(join(folder, "s.glb"))));
});

test("evaluate takes depth without an unknown shift", () => {
  const { status, stdout } = run("evaluate relative", ...relative);
  assert.equal(status, 1);
  assert.match(stdout, /INVALID_ARGUMENT: depthKind: .*unknown shift/);
  const scaled = succeeds("evaluate metric --depth-kind scale-invariant --json e.json --csv e.csv");
  hasNoMetres(scaled.stdout);
  assert.match(scaled.stdout, /Chamfer +0\.\d+ units/);
  assert.equal(results("e.json").metric.isMetric, false);
  assert.match(read("e.csv"), /\nmetric,,,,false,/);
});

test("wrong usage is refused", () => {
  const parts = "--depth metric/depth.npy --mask metric/mask.png";
  refusesUsage({
    "align metric --depth-kind relative": /Allowed choices are metric, scale-invariant, affine-invariant/,
    "align taken/rgb.jpg": /is a photo: pass its --depth, --mask and --mesh/,
    [`align taken/rgb.jpg ${parts}`]: /belong together: pass all three/,
    [`align taken/rgb.jpg metric ${parts}`]: /but not both/,
    [`align taken/rgb.jpg ${parts} --mesh metric/mesh.glb --image taken/rgb.jpg`]: /one photo/,
    "scene table --depth-kind affine-invariant --mjcf m": /--mjcf needs metres.*--known-extent/,
    "scene table --depth-kind scale-invariant --usd s.usda --scale 0.01,0.5": /--usd needs metres/,
  });
});
