/** `align --report --overlay --glb`: the files, and what a resumed batch draws. */
import assert from "node:assert/strict";
import { readdirSync, readFileSync, rmSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import vm from "node:vm";
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

interface Report {
  rows: { name: string; folder?: string; confidence: number | null; iou: number; error?: { code: string } }[];
  details: Record<
    string,
    { matrix: number[]; limitM: number; isPhoto: boolean; space: { triangles: string; points: string } }
  >;
}

/** The rows and details of a report, run as its page runs them. */
function reportOf(name: string): Report {
  const context = vm.createContext({ sim3align: { rows: [], details: {} } });
  const load = (file: string) => vm.runInContext(read(join(name, file)), context);
  load("rows.js");
  const report = context.sim3align as Report;
  for (const row of report.rows) if (row.folder !== undefined) load(join("cases", row.folder, "details.js"));
  return report;
}

const names = ["one", "Photo", "obj", "several/frame_0", "several/frame_1", "broken"];
const flags = "--quality fast --report report --overlay overlay --glb posed --json report.json";
const made = run(`align one Photo obj several broken ${flags}`);

test("a report has a page without links to elsewhere, and a row and pictures for each case and frame", () => {
  assert.equal(made.status, 1, "one case is broken");
  assert.doesNotMatch(made.stderr, /no pictures/);
  assert.doesNotMatch(read(join("report", "index.html")), /(src|href)="https?:|import\(|type="module"/);
  const { rows, details } = reportOf("report");
  assert.deepEqual(rows.map((row) => row.name).sort(), [...names].sort());
  const json = results("report.json");
  for (const row of rows) {
    const [name = "", part] = row.name.split("/");
    const entry =
      part === undefined ? json[name] : json[name].views.find((view: { name: string }) => view.name === part);
    if (name === "broken") {
      assert.deepEqual([row.error?.code, row.folder], [entry.error.code, undefined]);
      continue;
    }
    assert.deepEqual([row.confidence, row.iou], [entry.confidence, entry.metrics.iou], row.name);
    const { matrix, limitM, space, isPhoto } = details[row.folder as string] as Report["details"][""];
    assert.ok(limitM > 0 && space.triangles.length > 100 && space.points.length > 100);
    assert.deepEqual([Array.from(matrix), isPhoto], [entry.matrix, name === "Photo"]);
    const pictures = readdirSync(join(folder, "report", "cases", row.folder as string));
    for (const file of ["ground", "mask", "mesh", "outlines", "residual", "thumbnail"]) {
      assert.ok(pictures.includes(`${file}.png`), file);
    }
  }
  // The name is not one that all file systems tell apart.
  assert.match(rows.find((row) => row.name === "Photo")?.folder ?? "", /^Photo-[0-9a-f]{8}$/);
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
  const { rows, details } = reportOf("resumed");
  assert.deepEqual(rows.map((row) => row.name).sort(), ["obj", "one", "two"]);
  assert.deepEqual(Object.keys(details).sort(), ["obj", "one", "two"]);
});
