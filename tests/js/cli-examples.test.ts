/** The examples of the help texts, and the commands of the documents: each runs as written, on data of the names that it uses. */
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { chmodSync, cpSync, readdirSync, readFileSync } from "node:fs";
import { delimiter, join } from "node:path";
import { before, test } from "node:test";
import { resultsText, writeBop } from "../support/bop-dataset.js";
import { files, folder, pixels, run, writeCase } from "../support/command-line.js";
import { commandLine, repository } from "../support/environment.js";
import { cocoRle, glb, npy, obj, png, writeFiles } from "../support/files.js";
import { frameAt, frameFiles } from "../support/rig.js";
import { sam3dFiles } from "../support/sam3d.js";
import { mesh, poseJson, truth, view } from "../support/scene.js";
import { masks, poses, standingGlb, tableFiles, tableView } from "../support/table.js";
import { deflated, zip } from "../support/zip.js";

const skip = process.platform === "win32" ? "the examples are for a POSIX shell" : false;

/** Runs a line of a shell in a folder of the data. */
function shell(line: string, cwd: string): string {
  const env = { ...process.env, PATH: `${join(folder, "bin")}${delimiter}${process.env.PATH}` };
  const { status, stdout, stderr } = spawnSync("sh", ["-c", line], { cwd, encoding: "utf8", env });
  assert.equal(status, 0, stderr);
  assert.ok((stdout + stderr).trim() !== "", "it says something");
  return stdout;
}

const write = (path: string, content: Uint8Array | string | object) => writeFiles(folder, { [path]: content });

const tableMask = (i: number) => png(masks[i] as Uint8Array, tableView.width, tableView.height);

/** Frames whose cameras are known only through the object. */
function writeFrames(name: string, angles: readonly number[]): void {
  writeCase(name, { "mesh.glb": glb(mesh) });
  for (const [k, angle] of angles.entries()) writeCase(`${name}/frame_0${k}`, frameFiles(frameAt(angle)));
}

before(() => {
  for (const name of ["cases/mug", "cases/pan"]) writeCase(name, { ...files, "gt.json": poseJson(truth) });
  write("annotated.json", poseJson(truth));
  const { width, height, depth } = view;
  write("d.npy", npy(depth, height, width));
  write("moge.npz", zip([deflated("depth.npy", npy(depth, height, width))]));
  const millimetres = Uint16Array.from(depth, (z) => Math.round(1000 * z));
  write("d.png", png(millimetres, width, height));
  write("m.png", pixels);
  write("mug.glb", glb(mesh));
  write("mug.obj", obj(mesh));
  // Formats are told by the content.
  write("photo.jpg", png(new Uint8Array(3 * width * height).fill(90), width, height, 3));
  writeFrames("views/mug", [0, 40]);
  writeFrames("videos/mug", [0, 3]);
  writeCase("scenes/desk", tableFiles());
  const objects = poses.map((pose, i) => ({ name: `thing-${i}`, mask: tableMask(i), glb: standingGlb, pose }));
  writeCase("outputs/desk", sam3dFiles(tableView, objects));

  const found = writeBop(join(folder, "bop", "lmo"));
  // A target is enough.
  write("bop/lmo/test_targets_bop19.json", [{ scene_id: 2, im_id: 3, obj_id: 3, inst_count: 1 }]);
  for (const name of ["ycbv", "tless"])
    cpSync(join(folder, "bop", "lmo"), join(folder, "bop", name), { recursive: true });
  cpSync(join(folder, "bop/tless/test"), join(folder, "bop/tless/test_primesense"), { recursive: true });
  cpSync(join(folder, "bop/tless/models"), join(folder, "bop/tless/models_cad"), { recursive: true });
  cpSync(join(folder, "bop/lmo/models"), join(folder, "bop/models"), { recursive: true });
  cpSync(join(folder, "bop/lmo/test/000003"), join(folder, "bop/test/000048"), { recursive: true });
  const mask = found.get(join("test", "000002", "mask_visib", "000003_000000.png")) as Uint8Array;
  const detection = { scene_id: 2, image_id: 3, category_id: 3, score: 0.9, time: 0.5 };
  write("cnos_lmo-test.json", [{ ...detection, segmentation: cocoRle(mask, 640, 480) }]);
  write("other_lmo-test.csv", resultsText());
  write("bin/sim3align", `#!/bin/sh\nexec "${process.execPath}" "${commandLine}" "$@"\n`);
  write("bin/npx", `#!/bin/sh\nexec "$@"\n`);
  // As much of jq as the examples use.
  const follow = `process.argv[1].slice(1).split(".").reduce((value, key) => value[key], JSON.parse(fs.readFileSync(0)))`;
  write("bin/jq", `#!/bin/sh\nexec "${process.execPath}" -p '${follow}' "$1"\n`);
  for (const name of ["sim3align", "npx", "jq"]) chmodSync(join(folder, "bin", name), 0o755);
});

for (const command of ["", "align", "scene", "track", "evaluate", "bop"]) {
  const help = run(...(command === "" ? [] : [command]), "--help").stdout;
  const lines = (/\nExamples\n((?: {2}.*\n)+)/.exec(help)?.[1] ?? "").trimEnd().split("\n");
  // In the first text, explanations follow.
  const examples = lines.map((line) => line.trim().split(/ {3,}/)[0] as string);

  test(`sim3align ${command} --help has examples`, () => {
    assert.ok(examples.length >= 3, help);
    for (const example of examples) assert.match(example, new RegExp(`sim3align ${command}`));
  });

  for (const example of examples) {
    test(example, { skip }, () => {
      const stdout = shell(example, folder);
      if (example.includes("jq")) assert.ok(Number(stdout) > 0, stdout);
    });
  }
}

/** What the documents' commands read: the data of the help texts, some under other names. */
const data = ["bop", "cases", "outputs", "scenes", "videos", "views", "d.png", "m.png", "mug.glb", "photo.jpg"];
const others = {
  ...{ "cases/mug": "mug", cases: "target/cases/cases/lmo" },
  ...{ "d.npy": "depth.npy", "moge.npz": "depth.npz", "m.png": "mask.png" },
};
const documents = join(folder, "documents");
before(() => {
  const copies = [
    ...[...data, "cnos_lmo-test.json", "other_lmo-test.csv"].map((name) => [name, name]),
    ...Object.entries(others),
  ];
  for (const [from = "", to = ""] of copies) cpSync(join(folder, from), join(documents, to), { recursive: true });
});

const guides = readdirSync(join(repository, "docs", "guides")).map((name) => join("docs", "guides", name));
const known = new Set<string>();
for (const document of ["README.md", ...guides]) {
  const text = readFileSync(join(repository, document), "utf8");
  for (const [, command = ""] of text.matchAll(/^ {4}(npx sim3align .*)$/gm)) {
    if (known.has(command)) continue;
    known.add(command);
    test(`${document}: ${command}`, { skip }, () => void shell(command, documents));
  }
}
