/** Files of the command line: no output takes the place of an input or of another output, and all appear whole or not at all. */
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { linkSync, mkdirSync, readdirSync, readFileSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { readImage, readMesh } from "sim3align/formats";
import { writeBop } from "../support/bop.js";
import {
  files,
  folder,
  read,
  refusesUsage,
  results,
  run,
  succeeds,
  withFaults,
  writeCase,
} from "../support/command-line.js";
import { tableFiles } from "../support/table.js";

const inFolder = (...path: string[]) => join(folder, ...path);

writeCase("blob", files);
writeCase("mesh", files);
writeCase("rgb", { ...files, "rgb.png": files["mask.png"] });
writeCase(".", files);
writeCase("table", tableFiles(1));
const texture = { "mesh.gltf": { images: [{ uri: "textures/wood.png" }] }, "wood.png": files["mask.png"] };
writeCase("wood", { ...files, ...texture });
rmSync(inFolder("wood", "mesh.glb"));
writeBop(inFolder("bop"));
writeFileSync(inFolder("list.lock"), "blob\n");
symlinkSync(join("table", "depth.npy"), inFolder("link.usda"));
linkSync(inFolder("table", "depth.npy"), inFolder("hard.usda"));
symlinkSync("table", inFolder("named"));
mkdirSync(inFolder("store"));
linkSync(inFolder("table", "objects", "thing-0", "mesh.glb"), inFolder("store", "table.glb"));

/** The checksums of all files below a folder, by their paths. */
function sums(at = folder): Record<string, string> {
  const paths = readdirSync(at, { recursive: true, withFileTypes: true }).flatMap((entry) =>
    entry.isFile() ? [join(entry.parentPath, entry.name)] : [],
  );
  return Object.fromEntries(paths.map((path) => [path, createHash("sha256").update(readFileSync(path)).digest("hex")]));
}

test("an output that is an input or another output, by whatever name, is refused, and nothing is written", () => {
  const parts = "--depth depth.npy --mask mask.png --mesh mesh.glb --camera camera.json";
  const before = sums();
  refusesUsage({
    [`align ${parts} --glb .`]: /--mesh and --glb name the same file: mesh\.glb/,
    [`align ${parts} --csv blob/../mask.png`]: /--mask and --csv name the same file/,
    "align mesh --glb mesh": /--glb mesh.mesh\.glb: this is a file of the input mesh/,
    "align rgb --overlay ./rgb": /rgb\.png: this is a file of the input/,
    "align --list list.lock --jsonl list": /--list and the lock of --jsonl name the same file/,
    "evaluate blob --json blob/gt.json": /gt\.json: this is a file of the input/,
    "scene table --usd table/depth.npy": /depth\.npy: this is a file of the input/,
    "scene table --scene-glb table/objects/thing-0/mesh.glb": /mesh\.glb: this is a file of the input/,
    "scene table --usd link.usda": /link\.usda: this is a file of the input/,
    "scene table --usd hard.usda": /hard\.usda: this is a file of the input table/,
    "scene named --usd table/./depth.npy": /depth\.npy: this is a file of the input/,
    "scene table --usd named/no/../depth.npy": /depth\.npy: this is a file of the input/,
    "scene table --glb store": /table\.glb: this is a file of the input table/,
    "scene table --jsonl x --usd ./x": /--jsonl and --usd name the same file/,
    "scene table --json x --scene-glb x": /--json and --scene-glb name the same file/,
    "scene table --mjcf x --urdf x": /--mjcf and --urdf name the same file/,
    "align wood --overlay wood": /wood\.png: this is a file of the input wood.mesh\.gltf/,
    "scene --sam3d table --scene-glb table/new.glb --depth-kind metric":
      /new\.glb: this is a file of the input .*table/,
    "bop bop --split test --glb bop/test/new": /new.*: this is a file of the input .*bop.test/,
    "scene bop/test/000001 --usd bop/models/obj_000001.ply":
      /obj_000001\.ply: this is a file of the input .*bop.models/,
    "scene bop/test/000001 --models store --scene-glb store/x": /store.x: this is a file of the input .*store/,
    "align blob --report x --csv x/rows.js": /--csv and --report name the same file/,
  });
  assert.deepEqual(sums(), before);
});

test("on a full disk, files are whole or absent, the status is 1, and --resume makes what is missing", async () => {
  const outputs = "--jsonl r.jsonl --overlay full --glb posed --report report";
  const batch = `align blob mesh --quality fast --workers 1 --resume ${outputs}`;
  const scene = "scene table --quality fast --jsonl s.jsonl --resume --scene-glb full/s.glb --urdf full/urdf --parts 1";
  for (const name of ["full", "posed"]) mkdirSync(inFolder(name));
  const restore = withFaults({ full: "full" });
  for (const [words, message] of [
    [batch, /error: blob: .*full.blob\.png: cannot be written: ENOSPC.*error: mesh: .*full.mesh\.png/s],
    [scene, /error: table: .*full.s\.glb: cannot be written: ENOSPC/],
    ["align blob --quality fast --json full/x.json", /error: full.x\.json: cannot be written: ENOSPC/],
    ["align blob --quality fast --jsonl full/x.jsonl", /error: .*full.x\.jsonl.* cannot be written: ENOSPC/],
  ] as const) {
    const { status, stderr } = run(words);
    assert.equal(status, 1, words);
    assert.match(stderr, message);
  }
  restore();
  const left = readdirSync(inFolder("full"), { recursive: true, withFileTypes: true }).filter((entry) =>
    entry.isFile(),
  );
  assert.deepEqual(
    left.map(({ name }) => name),
    [],
  );
  succeeds(batch);
  succeeds(scene);
  // In the folder of a case, other names than those of its files are free.
  for (const _ of ["first", "again"]) succeeds("align blob --quality fast --overlay blob --json blob/results.json");
  for (const name of ["blob", "mesh"]) {
    assert.ok((await readImage(readFileSync(inFolder("full", `${name}.png`)))).width > 0);
    assert.ok((await readMesh(readFileSync(inFolder("posed", `${name}.glb`)))).positions.length > 0);
  }
  // What is done is made again only where it is missing.
  for (const path of ["posed/mesh.glb", "full/s.glb", "full/urdf/scene.json"]) rmSync(inFolder(path));
  const records = ["r.jsonl", "s.jsonl"].map(read);
  succeeds(batch);
  succeeds(scene);
  for (const path of ["posed/mesh.glb", "full/s.glb"]) await readMesh(readFileSync(inFolder(path)));
  assert.ok(read("full/urdf/scene.json").length > 0);
  assert.deepEqual(["r.jsonl", "s.jsonl"].map(read), records);
});

test("two cases that would have one picture: the first has it, and the second fails", () => {
  writeCase("p", { "mesh.glb": files["mesh.glb"] });
  const { "mesh.glb": _, ...frame } = files;
  writeCase("p/frame_0", frame);
  writeCase("p/frame_0", { "mesh.glb": files["mesh.glb"] });
  writeCase("q/frame_0", files);
  const words = "align p p/frame_0 q/frame_0 --quality fast --workers 1 --overlay twice --json twice.json";
  const { status, stderr } = run(words);
  assert.equal(status, 1);
  assert.match(stderr, /error: p.frame_0: --overlay .*: two files have this name/);
  assert.deepEqual(Object.keys(results("twice.json")), ["p", "p/frame_0", "q/frame_0"]);
});
