/** `align --report --overlay --glb`: the files, what a resumed batch draws, and what is refused. */
import assert from "node:assert/strict";
import { existsSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import vm from "node:vm";
import { createAligner } from "sim3align";
import { fromFrame, toSim3 } from "sim3align/conventions";
import { readImage } from "sim3align/formats";
import {
  files,
  folder,
  interrupted,
  read,
  refusesUsage,
  results,
  run,
  succeeds,
  writeCase,
} from "../support/command-line.js";
import { npy, obj, png } from "../support/files.js";
import { assertValid } from "../support/gltf-validator.js";
import { input, mesh, poseJson, truth, view } from "../support/scene.js";

const { width, height, depth } = view;
const gt = poseJson(truth);
for (const name of ["one", "two"]) writeCase(name, { ...files, "gt.json": gt });
const rgb = Uint8Array.from({ length: 3 * 4 * width * height }, (_, i) => (i * 7) % 256);
writeCase("Photo", { ...files, "rgb.png": png(rgb, 2 * width, 2 * height, 3) });
const { "mesh.glb": _, ...noMesh } = files;
writeCase("obj", { ...noMesh, "mesh.obj": obj(mesh) });
writeCase("broken", { "depth.npy": npy(depth, height, width) });

const quick = ["--quality", "fast"];

/** The rows and details of a report, run as its page runs them. */
function reportOf(name: string) {
  const context = vm.createContext({ sim3align: { rows: [], details: {} } });
  const load = (file: string) => vm.runInContext(read(join(name, file)), context);
  load("rows.js");
  const { rows, details } = context.sim3align as {
    rows: { name: string; folder?: string; confidence: number | null; iou: number; error?: { code: string } }[];
    details: Record<
      string,
      { matrix: number[]; limitMm: number; isPhoto: boolean; space: { triangles: string; points: string } }
    >;
  };
  for (const row of rows) if (row.folder !== undefined) load(join("cases", row.folder, "details.js"));
  return { rows, details };
}

test("a report has a page, a row for each case, and pictures", async () => {
  const names = ["one", "Photo", "obj", "broken"];
  const flags = ["--report", "report", "--overlay", "overlay", "--glb", "posed", "--json", "report.json"];
  const { status, stderr } = run("align", ...names, ...quick, ...flags);
  assert.equal(status, 1, "one case is broken");
  assert.doesNotMatch(stderr, /no pictures/);
  const page = read(join("report", "index.html"));
  assert.doesNotMatch(page, /(src|href)="https?:|import\(|type="module"/);
  const { rows, details } = reportOf("report");
  assert.deepEqual(rows.map((row) => row.name).sort(), [...names].sort());
  const json = results("report.json");
  for (const row of rows) {
    if (row.name === "broken") {
      assert.equal(row.error?.code, json.broken.error.code);
      assert.equal(row.folder, undefined);
      continue;
    }
    assert.equal(row.confidence, json[row.name].confidence);
    assert.equal(row.iou, json[row.name].metrics.iou);
    const own = details[row.folder as string];
    assert.ok(
      own !== undefined && own.limitMm > 0 && own.space.triangles.length > 100 && own.space.points.length > 100,
    );
    assert.deepEqual(Array.from(own.matrix), json[row.name].matrix);
    assert.equal(own.isPhoto, row.name === "Photo");
    const made = readdirSync(join(folder, "report", "cases", row.folder as string));
    for (const file of ["ground", "mask", "mesh", "outlines", "residual", "thumbnail"])
      assert.ok(made.includes(`${file}.png`));
  }
  // The name is not one that all file systems tell apart.
  assert.match(rows.find((row) => row.name === "Photo")?.folder ?? "", /^Photo-[0-9a-f]{8}$/);
});

test("an overlay is the image with the silhouette that is measured", async () => {
  const { data, ...size } = await readImage(readFileSync(join(folder, "overlay", "one.png")));
  assert.deepEqual(size, { width, height });
  const { matrix, metrics } = results("report.json").one;
  // Over the shades of depth, the mesh is orange: more red than blue by far.
  const inMesh = Array.from({ length: width * height }, (_, i) => (data[3 * i] ?? 0) - (data[3 * i + 2] ?? 0) > 40);
  const { metrics: again } = await (await createAligner()).evaluate({ ...input }, { matrix });
  assert.equal(again.iou, metrics.iou);
  const [both, either] = [0, 0].map(
    (_, k) => inMesh.filter((is, i) => (k === 0 ? is && input.mask[i] : is || input.mask[i])).length,
  ) as [number, number];
  assert.ok(Math.abs(both / either - metrics.iou) < 0.12, `${both / either} and ${metrics.iou}`);
  const photo = readdirSync(join(folder, "overlay")).find((name) => name.startsWith("Photo-")) ?? "";
  assert.equal((await readImage(readFileSync(join(folder, "overlay", photo)))).width, 2 * width);
});

test("posed meshes are valid, and are where the pose says, also without a GLB", async () => {
  const aligner = await createAligner();
  const still = fromFrame(toSim3([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]), "opengl");
  for (const name of ["one", "obj"]) {
    const glb = Uint8Array.from(readFileSync(join(folder, "posed", `${name}.glb`)));
    // The GLB of the tests has faults of its own.
    if (name === "obj") await assertValid(glb);
    const { metrics } = await aligner.evaluate({ ...input, mesh: glb }, still);
    assert.ok(Math.abs((metrics.iou ?? 0) - results("report.json")[name].metrics.iou) < 1e-3);
  }
});

test("a resumed batch has the rows of all cases, and draws what is missing", async () => {
  const flags = [...quick, "--workers", "1", "--jsonl", "r.jsonl", "--report", "resumed"];
  const { stderr } = await interrupted(/^one .*\n/m, "SIGINT", "align", "one", "two", "obj", ...flags);
  assert.match(stderr, /with --resume/);
  rmSync(join(folder, "resumed", "cases", "one"), { recursive: true });
  const { status } = run("align one two obj", ...flags, "--resume");
  assert.equal(status, 0);
  const { rows, details } = reportOf("resumed");
  assert.deepEqual(rows.map((row) => row.name).sort(), ["obj", "one", "two"]);
  assert.deepEqual(Object.keys(details).sort(), ["obj", "one", "two"]);
});

test("cases with frames have a row and pictures for each frame", () => {
  const { "mesh.glb": glb, ...frame } = files;
  writeCase("several", { "mesh.glb": glb });
  for (const name of ["frame_0", "frame_1"]) writeCase(join("several", name), frame);
  succeeds("align several", ...quick, "--report", "frames");
  const { rows, details } = reportOf("frames");
  assert.deepEqual(
    rows.map((row) => row.name),
    ["several/frame_0", "several/frame_1"],
  );
  assert.equal(Object.keys(details).length, 2);
});

test("folders that cannot be used are refused before the first case", () => {
  writeFileSync(join(folder, "file"), "");
  mkdirSync(join(folder, "other"), { recursive: true });
  writeFileSync(join(folder, "other", "index.html"), "mine");
  refusesUsage({
    "align one --report file": /--report file: the folder cannot be made/,
    "align one --report other": /--report other: the folder has other content/,
    "align one --overlay file": /--overlay file/,
    "align one --glb file/below": /--glb/,
  });
  assert.equal(read(join("other", "index.html")), "mine");
  assert.ok(!existsSync(join(folder, "other", "rows.js")));
});
