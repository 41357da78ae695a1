/** `align --report --overlay --glb`: the files, and what a resumed batch draws. */
import assert from "node:assert/strict";
import { readdirSync, readFileSync, rmSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { createAligner } from "sim3align";
import { fromFrame } from "sim3align/conventions";
import { readImage } from "sim3align/formats";
import { files, folder, interrupted, read, results, run, succeeds, writeCase } from "../support/command-line.js";
import { obj, png } from "../support/files.js";
import { assertValid } from "../support/gltf-validator.js";
import { maskIou } from "../support/results.js";
import { input, mesh, poseJson, truth, view } from "../support/scene.js";

const { width, height } = view;
for (const name of ["one", "two"]) writeCase(name, { ...files, "gt.json": poseJson(truth) });
const rgb = Uint8Array.from({ length: 3 * 4 * width * height }, (_, i) => (i * 7) % 256);
writeCase("Photo", { ...files, "rgb.png": png(rgb, 2 * width, 2 * height, 3) });
const { "mesh.glb": glbFile, ...frame } = files;
writeCase("obj", { ...frame, "mesh.obj": obj(mesh) });
writeCase("broken", { "depth.npy": files["depth.npy"] });
writeCase("several", { "mesh.glb": glbFile });
for (const name of ["frame_0", "frame_1"]) writeCase(join("several", name), frame);

/** The rows of a report: the text of each cell, its sort key, and the folder of the pictures. */
function rowsOf(report: string) {
  const page = read(join(report, "index.html"));
  return page
    .split("<tr>")
    .slice(2)
    .map((row) => ({
      name: /<th scope=row>(.*?)<td/.exec(row)?.[1] ?? "",
      keys: Array.from(row.matchAll(/data-key="(.*?)"/g), ([, key = ""]) => (key === "" ? null : Number(key))),
      folder: /src="(cases\/[^/]*)\/photo\.png"/.exec(row)?.[1],
      codes: Array.from(row.matchAll(/<summary>(.*?)</g), ([, code]) => code),
    }));
}

const names = ["one", "Photo", "obj", "several/frame_0", "several/frame_1", "broken"];
const flags = "--quality fast --report report --overlay overlay --glb posed --json report.json";
const made = run(`align one Photo obj several broken ${flags}`);

test("a report has a page without links to elsewhere, and a row and pictures for each case and frame", () => {
  assert.equal(made.status, 1, "one case is broken");
  assert.doesNotMatch(made.stderr, /no pictures/);
  assert.doesNotMatch(read(join("report", "index.html")), /(src|href)="https?:|import\(|type="module"/);
  const rows = rowsOf("report");
  assert.deepEqual(rows.map((row) => row.name).sort(), [...names].sort());
  const json = results("report.json");
  for (const row of rows) {
    const [name = "", part] = row.name.split("/");
    const entry =
      part === undefined ? json[name] : json[name].views.find((view: { name: string }) => view.name === part);
    if (name === "broken") {
      assert.deepEqual([row.codes, row.folder], [[entry.error.code], undefined]);
      continue;
    }
    const [confidence, , scale, iou] = row.keys;
    assert.deepEqual([confidence, scale, iou], [entry.confidence, entry.scale, entry.metrics.iou], row.name);
    assert.deepEqual(readdirSync(join(folder, "report", row.folder ?? "")).sort(), [
      ...["overlay.png", "photo.png", "side.png"],
    ]);
  }
  // The name is not one that all file systems tell apart.
  assert.match(rows.find((row) => row.name === "Photo")?.folder ?? "", /^cases\/Photo-[0-9a-f]{8}$/);
});

test("from the side, the mesh is where the measured points are", async () => {
  const { data, width } = await readImage(readFileSync(join(folder, "report", "cases", "one", "side.png")));
  const sums = { mesh: [0, 0, 0], points: [0, 0, 0] };
  for (let i = 0; i < data.length / 3; i++) {
    const [red = 0, green = 0, blue = 0] = data.subarray(3 * i, 3 * i + 3);
    // The mesh is orange, depth is yellow to violet, and what nobody has seen is nearly white.
    const sum = red - blue > 90 && green < 0.7 * red ? sums.mesh : red < 240 || blue < 200 ? sums.points : undefined;
    for (const [k, x] of [i % width, Math.floor(i / width), 1].entries()) if (sum) sum[k] = (sum[k] ?? 0) + x;
  }
  for (const [what, [, , count = 0]] of Object.entries(sums)) assert.ok(count > 300, `${count} pixels of ${what}`);
  const middle = ([u = 0, v = 0, n = 1]: number[]) => [u / n, v / n];
  const [[u = 0, v = 0], [x = 0, y = 0]] = [middle(sums.mesh), middle(sums.points)];
  assert.ok(Math.hypot(u - x, v - y) < 0.35 * width, `${[u, v]} and ${[x, y]}`);
});

test("an overlay is the image with the silhouette that is measured", async () => {
  const { data, ...size } = await readImage(readFileSync(join(folder, "overlay", "one.png")));
  assert.deepEqual(size, { width, height });
  // Over the shades of depth, the mesh is orange: more red than blue by far.
  const inMesh = Uint8Array.from(input.mask, (_, i) => ((data[3 * i] ?? 0) - (data[3 * i + 2] ?? 0) > 40 ? 1 : 0));
  const [drawn, { iou }] = [maskIou(inMesh, input.mask), results("report.json").one.metrics];
  assert.ok(Math.abs(drawn - iou) < 0.12, `${drawn} and ${iou}`);
  const photo = readdirSync(join(folder, "overlay")).find((name) => name.startsWith("Photo-")) ?? "";
  assert.equal((await readImage(readFileSync(join(folder, "overlay", photo)))).width, 2 * width);
});

test("posed meshes are valid, and are where the pose is, also without a GLB", async () => {
  const aligner = await createAligner();
  const still = fromFrame([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], "opengl");
  for (const name of ["one", "obj"]) {
    const glb = new Uint8Array(readFileSync(join(folder, "posed", `${name}.glb`)));
    // The GLB of the tests has faults of its own.
    if (name === "obj") await assertValid(glb);
    const { metrics } = await aligner.evaluate({ ...input, mesh: glb }, still);
    assert.ok(Math.abs((metrics.iou ?? 0) - results("report.json")[name].metrics.iou) < 1e-3);
  }
});

test("a resumed batch has the rows of all cases, and draws what is missing", async () => {
  const args = "align one two obj --quality fast --workers 1 --jsonl r.jsonl --report resumed";
  const { stderr } = await interrupted(/^one .*\n/m, "SIGINT", ...args.split(" "));
  assert.match(stderr, /with --resume/);
  rmSync(join(folder, "resumed", "cases", "one"), { recursive: true });
  succeeds(`${args} --resume`);
  const rows = rowsOf("resumed");
  assert.deepEqual(rows.map((row) => row.name).sort(), ["obj", "one", "two"]);
  assert.deepEqual(rows.map((row) => row.folder).sort(), ["cases/obj", "cases/one", "cases/two"]);
});
