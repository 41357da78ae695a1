/** The command line, run as its users run it. */
import assert from "node:assert/strict";
import { rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { createAligner, OPTIONS, type Sim3 } from "sim3align";
import { files, folder, pixels, refusesUsage, results, run, succeeds, writeCase } from "../support/command-line.js";
import { cocoRle, gltfBuffer, gltfJson, obj, png } from "../support/files.js";
import { assertSameMetrics } from "../support/metrics.js";
import { withoutTimes } from "../support/results.js";
import { columnMajor, mesh, poseJson, truth, view } from "../support/scene.js";

const { width, height, depth, mask, camera } = view;
const gt = poseJson(truth);
const millimetres = Uint16Array.from(depth, (z) => Math.round(1000 * z));

writeCase("blob", { ...files, "gt.json": gt, "meta.json": { source: "generated" } });
writeCase("blob-other-formats", {
  "depth.png": png(millimetres, width, height),
  "mask.json": cocoRle(mask, width, height),
  "mesh.gltf": gltfJson(mesh, {}, { uri: "blob%20mesh.bin" }),
  "blob mesh.bin": gltfBuffer(mesh),
  "scene_camera.json": { "3": { cam_K: [camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1], depth_scale: 1 } },
  "gt.json": { available: false, symmetry: "unknown" },
});
writeCase("no-mask", { "depth.npy": files["depth.npy"], "mesh.glb": files["mesh.glb"], "camera.json": camera });
writeCase("empty-mask", { ...files, "mask.png": png(new Uint8Array(mask.length), width, height) });
writeCase("outside", { ...files, "mesh.gltf": gltfJson(mesh, {}, { uri: "../blob/mesh.glb" }) });
rmSync(join(folder, "outside", "mesh.glb"));

test("--help explains the layout, frames, units and exit status", () => {
  assert.match(succeeds("--help").stdout, /^Usage: sim3align.*align.*evaluate.*Examples/s);
  const { stdout } = succeeds("align --help");
  const words = ["depth.npy", "camera.json", "metres", "OpenCV", "Exit status", "--guard", "--initial", "Examples"];
  for (const word of words) assert.ok(stdout.includes(word), word);
  assert.match(run("evaluate --help").stdout, /transform file/);
});

test("there is a flag for every option, with its values and default", () => {
  const { stdout } = run("align --help");
  const help = stdout.replace(/\s+/g, " ");
  for (const { name, kind, default: value } of [...OPTIONS.align, ...OPTIONS.paper]) {
    const flag = name.replace(/M$/, "").replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`);
    assert.ok(stdout.includes(kind === "boolean" && value === true ? `--no-${flag}` : `--${flag}`), name);
  }
  assert.match(help, /--quality <name> how much work the search does \(auto, fast, balanced, best; default auto\)/);
  assert.match(help, /--ransac-iterations <n> [^(]*\(1 to 10000000; default 100000\)/);
  assert.match(help, /--known-extent <metres> [^(]*--known-extent-axis[^(]*\(above 0\)/);
});

test("a single case is shown in detail", () => {
  const { stdout, stderr } = succeeds("align blob --preset paper --seed 1");
  assert.equal(stderr, "", "no progress line without a terminal");
  assert.match(stdout, /scale s.*m per mesh unit.*Errors \(compared with gt\.json\)/s);
  for (const word of ["silhouette IoU", "ransac", "hypotheses"]) assert.ok(stdout.includes(word), word);
  assert.ok(!stdout.includes("confidence"), "the paper's method has none");
  assert.ok(!stdout.includes("\u001b["), "no colour without a terminal");
});

test("the default shows how sure it is, and what else the pose may be", () => {
  const { stdout } = succeeds("align blob");
  assert.match(stdout, /confidence +(\d\.\d\d|–), score \d\.\d{3}\n/);
  assert.match(stdout, /alternatives +(none|\d+, rotated by \d+° \(score \d\.\d{3}\))/);
  assert.match(stdout, /renders +\d+/);
  assert.ok(!stdout.includes("hypotheses"), "the paper's method has these");
});

test("--json has everything, as the documentation says", async () => {
  succeeds("align blob --json out.json --seed 5");
  const { blob } = results("out.json");
  const aligner = await createAligner();
  const input = { depth: files["depth.npy"], mask: pixels, mesh: files["mesh.glb"], camera };
  const alignment = await aligner.align(input, { seed: 5 });
  const { errors } = await aligner.evaluate(input, alignment, { truth });
  const { timingsMs, ...rest } = blob;
  assert.ok(timingsMs.total > 0);
  const pose = "scale rotation translation matrix quaternion confidence turnConfidence alternatives uncertainty";
  const keys = `${pose} metrics warnings depthUnit timingsMs diagnostics errors`;
  assert.deepEqual(Object.keys(blob), keys.split(" "));
  const same = withoutTimes(alignment);
  const written = <T extends Sim3>({ rotation, rotationMatrix, ...others }: T) => {
    return { ...others, rotation: rotationMatrix, quaternion: rotation };
  };
  const expected = { ...written(same), alternatives: same.alternatives.map(written), errors };
  // The truth's rotation comes as rows there, as a quaternion here.
  const { errors: foundErrors, ...found } = rest;
  const { errors: expectedErrors, ...others } = expected;
  assert.deepEqual(found, others);
  assert.deepEqual(Object.keys(foundErrors), Object.keys(expectedErrors ?? {}));
  assert.ok(Math.abs(foundErrors.scaleError - (expectedErrors?.scaleError ?? 9)) < 1e-6);
});

test("--json has the proportions that were asked for, with their pose", () => {
  succeeds("align blob --quality fast --proportions axes --json proportions.json");
  const { proportions } = results("proportions.json").blob;
  assert.deepEqual(
    [proportions.stretch.length, proportions.uncertainty.length, proportions.rotation.length],
    [3, 3, 3],
  );
  assert.deepEqual([proportions.matrix.length, proportions.quaternion.length], [16, 4]);
});

test("bad cases are reported, the good ones aligned, and the exit status tells", () => {
  const names = ["no-mask", "blob", "empty-mask", "nowhere", "outside", "blob-other-formats"];
  const { status, stdout } = run("align", ...names, "--json", "many.json", "--workers", "1");
  assert.equal(status, 1);
  const many = results("many.json");
  assert.deepEqual(Object.keys(many), names);
  const codes = names.map((name) => many[name].error?.code);
  assert.deepEqual(codes, ["FILE_NOT_FOUND", undefined, "EMPTY_MASK", "FILE_NOT_FOUND", "CORRUPT_FILE", undefined]);
  assert.match(many["no-mask"].error.message, /mask: .*no-mask.*mask\.png or mask\.npy or mask\.json/);
  assert.deepEqual(Object.keys(many["no-mask"].error), ["code", "argument", "found", "expected", "remedy", "message"]);
  assert.equal(many["empty-mask"].error.file, join("empty-mask", "mask.png"));
  assert.match(many.outside.error.message, /in the folder of the \.gltf/);
  assert.equal("errors" in many["blob-other-formats"], false, "no truth, no errors");
  const lines = stdout.split("\n");
  assert.match(lines[0] ?? "", /^case +conf\. +alt\. .*IoU.*time s.*Δrot °/);
  names.forEach((name, i) => {
    assert.ok(lines[i + 1]?.startsWith(name), `row ${i} is ${name}`);
  });
  assert.match(stdout, /empty-mask: EMPTY_MASK: mask: found no non-zero pixel/);
});

test("files among the folders are passed over, but not files alone", () => {
  const { stderr } = succeeds("align blob out.json --json among.json");
  assert.match(stderr, /not a folder: out\.json/);
  assert.deepEqual(Object.keys(results("among.json")), ["blob"]);
  refusesUsage({ "align out.json": /./ });
});

test("metrics are left out on request", () => {
  succeeds("align blob --no-metrics --quality fast --json bare.json");
  assert.equal("metrics" in results("bare.json").blob, false);
  const { stdout } = run("align blob --no-metrics --quality fast");
  assert.ok(stdout.includes("confidence") && !stdout.includes("silhouette IoU"));
});

test("two readings of one case agree", () => {
  run("align blob blob-other-formats --json two.json");
  const { blob, "blob-other-formats": other } = results("two.json");
  assert.ok(Math.abs(blob.diagnostics.initialScale / other.diagnostics.initialScale - 1) < 0.01);
});

test("cases of the same name are told apart by their paths", () => {
  writeCase(join("a", "blob"), files);
  succeeds("align blob a/blob --workers 1 --json names.json");
  assert.deepEqual(Object.keys(results("names.json")), ["blob", "a/blob"]);
});

test("--json - leaves stdout to the JSON", () => {
  const { stdout, stderr } = succeeds("align blob --json -");
  assert.ok(JSON.parse(stdout).blob.scale > 0);
  assert.match(stderr, /silhouette IoU/);
});

test("a case can be named file by file", () => {
  const parts = ["--depth", "blob/depth.npy", "--mask", "blob/mask.png", "--mesh", "blob/mesh.glb"];
  const intrinsics = [camera.fx, camera.fy, camera.cx, camera.cy].join(",");
  for (const value of [intrinsics, "blob/camera.json"]) {
    succeeds("align", ...parts, "--camera", value, "--json", "parts.json", "--seed", "5");
    assert.equal(results("parts.json").mesh.scale, results("out.json").blob.scale);
  }
  succeeds("align", ...parts, "--camera", "fov:22.6");
  writeFileSync(join(folder, "mesh.obj"), obj(mesh));
  const units = ["--depth", "blob-other-formats/depth.png", "--depth-scale", "0.001"];
  succeeds("align", ...units, ...parts.slice(2, 4), "--mesh", "mesh.obj", "--camera", intrinsics);
});

test("flags reach the core", () => {
  const guard = "--guard 0.9,1.1 --guard-mode clamp --icp none --voxel-divisions 20 --no-lock-scale";
  const more = '--no-hallucination-filter --ransac-iterations 500 --options {"seed":4}';
  succeeds(`align blob --preset paper ${guard} ${more} --json flags.json`);
  const { blob } = results("flags.json");
  const { seed, counts, scaleRatio } = blob.diagnostics;
  assert.equal(seed, 4);
  assert.equal(counts.icpIterations, 0);
  assert.ok(counts.iterations <= 500);
  assert.ok(scaleRatio >= 0.9 - 1e-9 && scaleRatio <= 1.1 + 1e-9);
  assert.deepEqual([blob.confidence, blob.alternatives, blob.uncertainty], [null, [], null]);
  succeeds('align blob --preset paper --options {"seed":4} --seed 6 --guard none --json f.json');
  assert.equal(results("f.json").blob.diagnostics.seed, 6, "flags have precedence");
  assert.equal(results("f.json").blob.diagnostics.counts.rejected, 0);
});

test("the flags of precise are taken", () => {
  // The last one reads the file that it writes.
  const accepted = [
    "--scale 0.05,0.2 --work-budget 100",
    "--scale free",
    "--known-extent 0.2 --known-extent-axis longest --symmetry none",
    '--camera-up -1,0,0 --mesh-up 0,1,0 --symmetry [{"axis":[0,0,1],"fold":2}]',
    "--initial blob/gt.json --search local --no-metrics",
    "--initial precise.json --search local",
  ];
  for (const flags of accepted) {
    succeeds(`align blob --quality fast --json precise.json ${flags}`);
    assert.equal(results("precise.json").blob.diagnostics.preset, "precise");
  }
});

test("an initial pose that can't be used fails the case, not the others", () => {
  const initial = (file: string, ...flags: string[]) => {
    const { status } = run("align blob --quality fast --initial", file, ...flags, "--json", "initial.json");
    return [status, results("initial.json").blob.error?.code, results("initial.json").blob.error?.argument];
  };
  assert.deepEqual(initial("missing.json"), [1, "FILE_NOT_FOUND", "initial"]);
  assert.deepEqual(initial("blob/camera.json"), [1, "INVALID_TRANSFORM", "initial"]);
  assert.deepEqual(initial("blob/gt.json", "--scale", "1"), [1, "INVALID_OPTION", "options.initial"]);
});

test("wrong usage is refused", () => {
  refusesUsage({
    align: /at least one case folder/,
    "aling blob": /unknown command/,
    "align blob --sead 1": /unknown option '--sead'.*--seed/s,
    "align blob --preset fast": /Allowed choices are precise, paper/,
    "align blob --quality ultra": /Allowed choices are auto, fast, balanced, best/,
    "align blob --guard none": /options\.guard.*option of preset "paper"/,
    "align blob --preset paper --search global": /options\.search.*"precise"/,
    "align blob --scale big": /MIN,MAX/,
    "align blob --scale 1,2,3": /MIN,MAX/,
    "align blob --scale 0": /options\.scale.*above 0/,
    "align blob --camera-up 0,1": /X,Y,Z/,
    "align blob --camera-up 0,-1,0": /options\.meshUp/,
    "align blob --known-extent 0.1 --scale 1": /options\.knownExtentM/,
    "align blob --search local": /options\.search.*initial/,
    "align blob --symmetry round": /options\.symmetry/,
    "align blob --symmetry [{axis}]": /Invalid JSON/,
    "align blob --seed one": /Not a number/,
    "align blob --guard 0.5": /MIN,MAX/,
    "align blob --options {seed:1}": /Invalid JSON/,
    "align blob --options [1]": /Expected an object/,
    "align blob --preset paper --voxel-divisions 1": /options\.voxelDivisions: found 1.*from 5 to 200/,
    'align blob --options {"sead":1}': /options\.sead/,
    "align --depth blob/depth.npy": /belong together/,
    "align blob --camera 1066,1067,312": /Found 3 values, expected four numbers: fx,fy,cx,cy/,
    "align blob --camera 600,600,320,24O": /expected four numbers/,
    "align blob --camera 0,600,320,240": /focal lengths above 0/,
    "align blob --camera fov:500": /above 0 and below 180/,
    "align blob --depth blob/depth.npy": /but not both/,
    evaluate: /Pass at least one case folder/,
  });
});

test("evaluate scores the truth, a file, and what align wrote", () => {
  const { stdout } = succeeds("evaluate blob --json truth.json");
  assert.match(stdout, /silhouette IoU.*Errors \(compared with gt\.json\).*rotation +0\.00°/s);
  const { blob } = results("truth.json");
  assert.ok(blob.metrics.iou > 0.99);
  assert.ok(blob.errors.scaleError < 1e-6);
  writeFileSync(join(folder, "matrix.json"), JSON.stringify({ matrix: columnMajor(truth) }));
  writeFileSync(join(folder, "bare.json"), JSON.stringify(columnMajor(truth)));
  for (const file of ["matrix.json", "bare.json", join("blob", "gt.json")]) {
    succeeds("evaluate blob --transform", file, "--json", "file.json");
    assert.ok(Math.abs(results("file.json").blob.metrics.iou - blob.metrics.iou) < 1e-6, file);
  }
  run("align blob empty-mask --workers 1 --json aligned.json");
  succeeds("evaluate blob --transform aligned.json --json scores.json");
  assertSameMetrics(results("scores.json").blob.metrics, results("aligned.json").blob.metrics);
});

test("evaluate reports what it can't do", () => {
  const failing: [args: string, code: string, message: RegExp][] = [
    ["nowhere", "FILE_NOT_FOUND", /nowhere/],
    ["blob-other-formats", "FILE_NOT_FOUND", /no true pose/],
    ["blob --transform missing.json", "FILE_NOT_FOUND", /missing\.json/],
    ["blob --transform blob/mask.png", "CORRUPT_FILE", /JSON/],
    ["empty-mask --transform aligned.json", "INVALID_TRANSFORM", /the failure of empty-mask/],
    ["blob-other-formats --transform aligned.json", "INVALID_TRANSFORM", /blob, empty-mask/],
  ];
  for (const [args, code, message] of failing) {
    const { status, stdout } = run(`evaluate ${args} --json failed.json`);
    assert.equal(status, 1, stdout);
    const { error } = Object.values(results("failed.json"))[0] as { error: { code: string; message: string } };
    assert.equal(error.code, code, error.message);
    assert.match(error.message, message);
    assert.match(stdout, message);
  }
});
