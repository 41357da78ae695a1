/** The command line with one photo: depth as models guess it, and no camera file. */
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { files, folder, read, results, succeeds, writeCase } from "../support/command-line.js";
import { greyJpeg, tiff } from "../support/exif.js";
import { npy } from "../support/files.js";
import { turnBetween } from "../support/rig.js";
import { mesh, poseJson, truth, type View, view } from "../support/scene.js";
import { deflated, zip } from "../support/zip.js";

const { width, height, camera } = view;
const { "camera.json": _, ...uncalibrated } = files;
const gt = poseJson(truth);
const relative = "--depth-kind affine-invariant-disparity --quality fast";

/** The output of a model of relative depth. */
const disparity = ({ depth, width, height }: Pick<View, "depth" | "width" | "height">) =>
  npy(
    depth.map((z) => (z > 0 ? 2 / z + 0.3 : Number.NaN)),
    height,
    width,
  );

/** A photo of the scene's camera: 65 mm on full frame are 300 pixels; that of the table: 37 mm are 171 pixels. */
const photoOf = (focal35: number) =>
  greyJpeg(tiff({ make: "Maker" }, { focal35, pixelX: width, pixelY: height }, true), width, height);

/** The largest extent of the mesh at the true pose, metres. */
const extentM = Math.max(
  ...[0, 1, 2].map((axis) => {
    const side = mesh.positions.filter((_, i) => i % 3 === axis);
    return truth.scale * (Math.max(...side) - Math.min(...side));
  }),
);

writeCase("taken", { ...uncalibrated, "rgb.jpg": photoOf(65) });
writeFileSync(join(folder, "d.npz"), zip([deflated("depth.npy", files["depth.npy"] as Uint8Array)]));
writeCase("alone", uncalibrated);
writeCase("relative", { ...files, "depth.npy": disparity(view), "gt.json": gt });
const { "depth.npy": __, ...withoutDepth } = uncalibrated;
writeCase("model", {
  ...withoutDepth,
  "depth.npz": zip([deflated("depth.npy", disparity(view))]),
  "rgb.jpg": photoOf(65),
});

/** Nothing that is printed may claim a length in metres. */
function hasNoMetres(printed: string): void {
  assert.doesNotMatch(printed.replace(/EXIF: .*/, ""), /\d (m|cm|mm)\b/);
  assert.equal(printed.match(/Lengths have no unit.*--known-extent/g)?.length, 1, printed);
}

test("the photo gives the focal length: as an argument, by --image, and in a case folder; without it, it is estimated", () => {
  const parts = "--mask taken/mask.png --mesh taken/mesh.glb --quality fast";
  const { stdout } = succeeds(`align taken/rgb.jpg --depth d.npz ${parts} --json argument.json`);
  assert.match(stdout, /depth unit +metres \(float values, assumed\)\n/);
  assert.match(stdout, /focal length +\d{3}\.\d px ± \d\.\d %, EXIF: 65 mm \(35 mm equivalent\)\n/);
  const { mesh: found } = results("argument.json");
  const { cameraSource, depthCalibration, depthUnit, warnings } = found;
  assert.match(cameraSource, /^EXIF: /);
  const { depthKind, isMetric } = depthCalibration;
  const unit = { metres: 1, source: "float values", isAssumed: true };
  assert.deepEqual([depthUnit, depthKind, isMetric, warnings], [unit, "metric", true, []]);
  assert.ok(Math.abs(depthCalibration.camera.fx / camera.fx - 1) < 0.05, `${depthCalibration.camera.fx}`);
  assert.ok(Math.abs(found.scale / truth.scale - 1) < 0.05 && turnBetween(found.rotation, truth.rotation) < 5);
  succeeds(`align --depth taken/depth.npy ${parts} --image taken/rgb.jpg --json flag.json`);
  succeeds("align taken --json folder.json --quality fast");
  for (const other of [results("flag.json").mesh, results("folder.json").taken]) {
    assert.deepEqual([other.matrix, other.depthCalibration], [found.matrix, depthCalibration]);
  }
  const alone = succeeds("align alone --json alone.json --quality fast").stdout;
  assert.match(alone, /focal length +\d+\.\d px ± \d+\.\d %, estimate\n/);
  assert.match(alone, /FOCAL_LENGTH_UNKNOWN/);
  assert.equal(results("alone.json").alone.depthCalibration.isFocalEstimated, true);
});

test("relative depth has no unit, and none is printed, until --known-extent makes it metric", () => {
  for (const name of ["relative", "model"]) {
    const { stdout } = succeeds(`align ${name} --json r.json ${relative}`);
    hasNoMetres(stdout);
    assert.match(stdout, /scale s +[\d.]+ units per mesh unit\n/);
    assert.match(stdout, /depth +affine-invariant-disparity, z = [\d.]+ \/ \(d [−+] [\d.]+\), ± [\d.]+ % of the/);
    const { [name]: entry } = results("r.json");
    // Errors against metres cannot be measured.
    assert.deepEqual([entry.depthCalibration.isMetric, "errors" in entry], [false, false]);
    assert.ok(turnBetween(entry.rotation, truth.rotation) < 6);
  }
  const { stdout } = succeeds(`align relative --json k.json ${relative} --known-extent ${extentM}`);
  assert.match(stdout, /scale s +[\d.]+ m per mesh unit\n/);
  assert.doesNotMatch(stdout, /have no unit/);
  const { depthCalibration, errors, scale, translation } = results("k.json").relative;
  assert.ok(depthCalibration.isMetric && Math.abs(scale / truth.scale - 1) < 1e-6);
  const off = Math.hypot(...truth.translation.map((x, i) => x - translation[i]));
  assert.ok(off < 0.05 * truth.translation[2], `${off}`);
  // They are measured in the corrected depth map.
  assert.ok(errors.rotationErrorDeg < 5 && errors.scaleError < 1e-6, JSON.stringify(errors));
});

test("a batch of relative depth: columns of metres are empty, and pictures are in its unit", () => {
  const batch = `align relative model ${relative} --csv b.csv --workers 1`;
  const { stdout, stderr } = succeeds(`${batch} --report report --overlay overlay --glb posed`);
  hasNoMetres(stdout);
  assert.doesNotMatch(stderr, /no pictures/);
  assert.match(stdout, /^case .*Chamfer mm.*Δtrans mm(.*\n)*model .* – /m);
  const [head = "", ...rows] = read("b.csv").trim().split("\n");
  for (const row of rows) {
    const cells = row.split(",");
    const of = Object.fromEntries(head.split(",").map((column, i) => [column, cells[i]]));
    assert.deepEqual([of.isMetric, of.txM, of.chamferM, of.depthMaeM], ["false", "", "", ""]);
    assert.ok(Number(of.scale) > 0 && Number(of.iou) > 0.9 && Number(of.timeMs) > 0);
  }
});
