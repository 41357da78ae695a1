/** `sim3align align` and `evaluate`: what they read, print and write, and their exit status. */
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { cpSync, rmSync, symlinkSync, truncateSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { createAligner, OPTIONS } from "sim3align";
import { files, folder, pixels, refusesUsage, results, run, succeeds, writeCase } from "../support/command-line.js";
import { cocoRle, gltfBuffer, gltfJson, npy, obj, png } from "../support/files.js";
import { withoutTimes } from "../support/results.js";
import { columnMajor, mesh, poseJson, truth, view } from "../support/scene.js";

const { width, height, depth, mask, camera } = view;
const K = [camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1];
const millimetres = Uint16Array.from(depth, (z) => Math.round(1000 * z));

writeCase("blob", { ...files, "gt.json": poseJson(truth), "meta.json": { source: "generated" } });
writeCase("others", {
  "depth.png": png(millimetres, width, height),
  "mask.json": cocoRle(mask, width, height),
  "mesh.gltf": gltfJson(mesh, {}, { uri: "blob%20mesh.bin" }),
  "blob mesh.bin": gltfBuffer(mesh),
  "scene_camera.json": { "3": { cam_K: K, depth_scale: 1 } },
  "gt.json": { available: false, symmetry: "unknown" },
});
writeCase("no-mask", { "depth.npy": files["depth.npy"], "mesh.glb": files["mesh.glb"], "camera.json": camera });
writeCase("empty-mask", { ...files, "mask.png": png(new Uint8Array(mask.length), width, height) });
writeCase("outside", { ...files, "mesh.gltf": gltfJson(mesh, {}, { uri: "../blob/mesh.glb" }) });
rmSync(join(folder, "outside", "mesh.glb"));
for (const name of ["pipe", "device", "large"]) {
  writeCase(name, files);
  rmSync(join(folder, name, "depth.npy"));
}
assert.equal(spawnSync("mkfifo", [join(folder, "pipe", "depth.npy"), join(folder, "pipe", "gt.json")]).status, 0);
symlinkSync("/dev/zero", join(folder, "device", "depth.npy"));
// Without content on the disk.
writeFileSync(join(folder, "large", "depth.npy"), "");
truncateSync(join(folder, "large", "depth.npy"), 3 * 2 ** 30);
const quick = ["--quality", "fast"];
test("--help explains the layout, frames, units and exit status, and has a flag for every option", () => {
  assert.match(succeeds("--help").stdout, /^Usage: sim3align.*align.*evaluate.*Examples/s);
  assert.match(run("evaluate --help").stdout, /transform file/);
  const { stdout: common } = succeeds("align --help");
  const { stdout: ofPaper } = succeeds("align --help paper");
  assert.ok(
    !common.includes("--support-angle-deg") && !ofPaper.includes("--known-extent") && !ofPaper.includes("Examples"),
  );
  const stdout = common + ofPaper;
  for (const word of ["depth.npy", "camera.json", "metres", "OpenCV", "Exit status"])
    assert.ok(stdout.includes(word), word);
  for (const { name, kind, default: value } of [...OPTIONS.align, ...OPTIONS.paper]) {
    const flag = name.replace(/M$/, "").replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`);
    assert.ok(stdout.includes(kind === "boolean" && value === true ? `--no-${flag}` : `--${flag}`), name);
  }
  const help = stdout.replace(/\s+/g, " ");
  assert.match(help, /--quality <name> how much work a search does \(auto, fast, balanced, best; default auto\)/);
  assert.match(help, /--ransac-iterations <n> [^(]*\(1 to 10000000; default 100000\)/);
});

test("a single case is shown in detail, by each method, without colours or progress where there is no terminal", () => {
  const { stdout, stderr } = succeeds("align blob");
  assert.equal(stderr, "");
  assert.match(stdout, /scale s.*m per mesh unit.*Errors \(compared with gt\.json\)/s);
  assert.match(stdout, /confidence +(\d\.\d\d|–), score \d\.\d{3}\n/);
  assert.match(stdout, /alternatives +(none|\d+, rotated by \d+° \(score \d\.\d{3}\))/);
  assert.ok(!stdout.includes("\u001b[") && !stdout.includes("hypotheses") && /renders +\d+/.test(stdout));
  const paper = succeeds("align blob --preset paper --seed 1").stdout;
  assert.ok(/silhouette IoU.*hypotheses/s.test(paper) && paper.includes("ransac") && !paper.includes("confidence"));
  const bare = succeeds("align blob --no-metrics --json bare.json", ...quick).stdout;
  assert.ok(!bare.includes("silhouette IoU") && !("metrics" in results("bare.json").blob));
});

test("--json has everything that align returns, and the proportions; --json - leaves stdout to it", async () => {
  const { stdout, stderr } = succeeds("align blob --json - --seed 5 --proportions axes", ...quick);
  assert.match(stderr, /silhouette IoU/);
  assert.equal(stdout, `${JSON.stringify(JSON.parse(stdout), null, 2)}\n`);
  const { blob } = JSON.parse(stdout);
  const aligner = await createAligner();
  const input = { depth: files["depth.npy"], mask: pixels, mesh: files["mesh.glb"], camera };
  const alignment = await aligner.align(input, { seed: 5, quality: "fast", proportions: "axes" });
  const { errors } = await aligner.evaluate(input, alignment, { truth });
  const { errors: foundErrors, inputs, unread, path, ...found } = blob;
  assert.equal(path, "blob");
  const parts = { "depth.npy": "depth", "mask.png": "mask", "mesh.glb": "mesh" };
  for (const [name, part] of Object.entries({ ...parts, "camera.json": "camera", "gt.json": "truth" }))
    assert.equal(inputs[name].as, part);
  assert.deepEqual([Object.keys(inputs).length, unread], [5, ["meta.json"]]);
  assert.ok(found.diagnostics.timingsMs.total > 0 && found.proportions !== undefined && errors !== null);
  assert.deepEqual(withoutTimes(found), withoutTimes(alignment));
  assert.deepEqual(Object.keys(foundErrors), Object.keys(errors));
  // The truth's rotation comes as rows there, as a quaternion here.
  assert.ok(Math.abs(foundErrors.scaleError - errors.scaleError) < 1e-6);
});

test("files that were read are named with how they were read; a line has the others, and one what was assumed", () => {
  const { "camera.json": _, ...rest } = files;
  const intrinsics = { fx: camera.fx, fy: camera.fy, cx: camera.cx, cy: camera.cy };
  writeCase("clean", { ...rest, "depth.npy": npy(millimetres, height, width) });
  writeCase("clean", { "K.json": { ...intrinsics, depthScale: 0.001 }, ".hidden": "", "results.json": "" });
  const clean = succeeds("align clean --json clean.json", ...quick).stdout;
  assert.doesNotMatch(clean, /not read|assumed/);
  const { inputs } = results("clean.json").clean;
  const unit = { metres: 0.001, source: "camera file: depthScale", isAssumed: false };
  assert.deepEqual(inputs["depth.npy"], { as: "depth", unit });
  assert.deepEqual(inputs["mask.png"], { as: "mask", reading: "values of 255" });
  assert.deepEqual(inputs["K.json"], { as: "camera" });
  writeCase("left", { ...rest, "depth.npy": npy(millimetres, height, width), "rgb.bmp": "", "pose.npy": "" });
  const left = succeeds("align left", ...quick).stdout;
  assert.match(
    left,
    /\n\nnot read: pose\.npy, rgb\.bmp\nassumed: depth unit 0\.001 m \(16-bit integers\); focal length\n$/,
  );
  writeCase("also-left", { ...rest, "depth.npy": npy(millimetres, height, width), "rgb.bmp": "", "pose.npy": "" });
  const both = succeeds("align left also-left clean --workers 1", ...quick).stdout;
  assert.match(both, /\nnot read: pose\.npy, rgb\.bmp \(left, also-left\)\n/);
});

test("bad cases are reported, the good ones aligned, and the exit status is that of a failure", () => {
  const unreadable = ["pipe", "device", "large"];
  const names = ["no-mask", "blob", "empty-mask", "nowhere", "outside", "others", "meta.json", ...unreadable];
  const { status, stdout, stderr } = run("align", ...names, "--json", "many.json", "--workers", "1", ...quick);
  assert.equal(status, 1);
  const many = results("many.json");
  const found = Object.entries<{ error?: { code: string } }>(many).map(([name, { error }]) => [name, error?.code]);
  const [missing, empty, corrupt] = ["FILE_NOT_FOUND", "EMPTY_MASK", "CORRUPT_FILE"];
  const unread = [missing, missing, "FILE_TOO_LARGE"];
  const codes = [missing, undefined, empty, missing, corrupt, undefined, missing, ...unread];
  for (const [i, name] of names.entries()) assert.deepEqual(found[i], [name, codes[i]], stderr);
  const properties = ["code", "argument", "found", "expected", "remedy", "message"];
  assert.deepEqual(Object.keys(many["no-mask"].error), properties);
  assert.match(many["no-mask"].error.message, /mask: .*no-mask.*mask\.png or mask\.npy or mask\.json/);
  assert.equal(many["empty-mask"].error.file, join("empty-mask", "mask.png"));
  assert.match(many.outside.error.message, /in the folder of the mesh/);
  for (const name of ["pipe", "device"]) assert.match(many[name].error.message, /no ordinary file at/);
  assert.equal("errors" in many.others, false, "no truth, no errors");
  const scales = [many.blob, many.others].map(({ diagnostics }) => diagnostics.initialScale);
  assert.ok(Math.abs(scales[0] / scales[1] - 1) < 0.01, "two readings of one case");
  const [head, ...rows] = stdout.split("\n");
  assert.match(head ?? "", /^case +conf\. +alt\. .*IoU.*time s.*Δrot °/);
  for (const [i, name] of names.entries()) assert.ok(rows[i]?.startsWith(name), `row ${i} is ${name}`);
  assert.match(stdout, /empty-mask: EMPTY_MASK: mask: found no non-zero pixel/);
});

test("a case can be named file by file, with its photo, which a folder may hold, too", () => {
  succeeds("align blob --seed 5 --json folder.json", ...quick);
  writeCase("photo", files);
  const parts = ["--depth", "blob/depth.npy", "--mask", "blob/mask.png", "--mesh", "blob/mesh.glb", ...quick];
  const intrinsics = [camera.fx, camera.fy, camera.cx, camera.cy].join(",");
  for (const value of [intrinsics, "blob/camera.json"]) {
    succeeds("align", ...parts, "--camera", value, "--json", "parts.json", "--seed", "5");
    assert.deepEqual(results("parts.json").mesh.matrix, results("folder.json").blob.matrix);
  }
  writeFileSync(join(folder, "mesh.obj"), obj(mesh));
  const units = ["--depth", "others/depth.png", "--depth-scale", "0.001", "--mask", "blob/mask.png", ...quick];
  succeeds("align", ...units, "--mesh", "mesh.obj", "--camera", "fov:22.6");
  writeFileSync(join(folder, "wide.png"), png(new Uint8Array(200), 20, 10));
  const outcome = (...args: string[]) => {
    const { status } = run("align", ...args, "--json", "image.json");
    return [status, Object.values<{ error?: { code: string } }>(results("image.json"))[0]?.error?.code];
  };
  const pinhole = ["--camera", intrinsics];
  assert.deepEqual(outcome(...parts, ...pinhole, "--image", "wide.png"), [1, "SIZE_MISMATCH"]);
  writeCase("photo", { "image.png": png(new Uint8Array(200), 20, 10) });
  assert.deepEqual(outcome("photo", ...quick), [1, "SIZE_MISMATCH"]);
  assert.deepEqual(outcome("photo", "--no-image", ...quick), [0, undefined]);
});

test("flags reach the core, before those of --options", () => {
  const guard = "--guard 0.9,1.1 --guard-mode clamp --icp none --voxel-divisions 20 --no-lock-scale";
  const more = '--no-hallucination-filter --ransac-iterations 500 --options {"seed":4} --surface-samples 3000';
  succeeds(`align blob --preset paper ${guard} ${more} --json flags.json`);
  const { blob } = results("flags.json");
  const { seed, counts, scaleRatio } = blob.diagnostics;
  assert.deepEqual([seed, counts.icpIterations], [4, 0]);
  assert.ok(counts.iterations <= 500 && scaleRatio >= 0.9 - 1e-9 && scaleRatio <= 1.1 + 1e-9);
  assert.equal("confidence" in blob, false);
  const flags: [flags: string, check: (found: Record<string, number>) => boolean][] = [
    ['--options {"seed":4} --seed 6', ({ seed }) => seed === 6],
    ["--scale 0.1,0.2 --work-budget 100", ({ scale = 0 }) => scale > 0.1 - 1e-9],
    ['--camera-up -1,0,0 --mesh-up 0,1,0 --symmetry [{"axis":[0,0,1],"fold":2}] --scale free', () => true],
    // It reads the file that it writes.
    ["--initial precise.json --search local", ({ renders = 9e9 }) => renders < 700],
  ];
  for (const [words, check] of flags) {
    succeeds(`align blob --json precise.json ${words}`, ...quick);
    const { scale, diagnostics } = results("precise.json").blob;
    const found = { scale, seed: diagnostics.seed, renders: diagnostics.counts.renders };
    assert.ok(diagnostics.preset === "precise" && check(found), `${words}: ${JSON.stringify(found)}`);
  }
});

test("evaluate scores the truth, a file, and what align wrote, and reports what it can't do", () => {
  const { stdout } = succeeds("evaluate blob --json truth.json");
  assert.match(stdout, /silhouette IoU.*Errors \(compared with gt\.json\).*rotation +0\.00°/s);
  const { metrics, errors } = results("truth.json").blob;
  assert.ok(metrics.iou > 0.99 && errors.scaleError < 1e-6);
  writeFileSync(join(folder, "matrix.json"), JSON.stringify({ matrix: columnMajor(truth) }));
  writeFileSync(join(folder, "bare.json"), JSON.stringify(columnMajor(truth)));
  for (const file of ["matrix.json", "bare.json", join("blob", "gt.json")]) {
    succeeds("evaluate blob --transform", file, "--json", "file.json");
    assert.ok(Math.abs(results("file.json").blob.metrics.iou - metrics.iou) < 1e-6, file);
  }
  run("align blob empty-mask --workers 1 --json aligned.json --jsonl aligned.jsonl", ...quick);
  const { metrics: aligned } = results("aligned.json").blob;
  for (const file of ["aligned.json", "aligned.jsonl"]) {
    succeeds(`evaluate blob --transform ${file} --json scores.json`);
    for (const [name, value] of Object.entries<number>(results("scores.json").blob.metrics)) {
      assert.ok(Math.abs(value - aligned[name]) <= 1e-9 * Math.abs(value), `${name}: ${value}, not ${aligned[name]}`);
    }
  }
  // A case whose name is a field of transforms.
  cpSync(join(folder, "blob"), join(folder, "scale"), { recursive: true });
  writeFileSync(
    join(folder, "named.json"),
    JSON.stringify({ scale: { ...results("aligned.json").blob, path: "scale" } }),
  );
  succeeds("evaluate scale --transform named.json");
  refusesUsage({ "evaluate blob --transform missing.json": /--transform missing\.json: there is no such file/ });
  const failing: [args: string, code: string, message: RegExp][] = [
    ["nowhere", "FILE_NOT_FOUND", /nowhere/],
    ["others", "FILE_NOT_FOUND", /no true pose/],
    ["blob --transform blob/mask.png", "CORRUPT_FILE", /JSON/],
    ["empty-mask --transform aligned.json", "INVALID_TRANSFORM", /the failure of empty-mask/],
    ["others --transform aligned.json", "INVALID_TRANSFORM", /blob, empty-mask/],
  ];
  for (const [args, code, message] of failing) {
    const { status, stdout } = run(`evaluate ${args} --json failed.json`);
    const [{ error }] = Object.values(results("failed.json")) as [{ error: { code: string; message: string } }];
    assert.deepEqual([status, error.code], [1, code], error.message);
    for (const text of [error.message, stdout]) assert.match(text, message);
  }
});
