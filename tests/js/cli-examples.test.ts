/** The examples of the help texts, and the commands of the documents: each runs as written, on data of the names that it uses. */
import assert from "node:assert/strict";
import { chmodSync, cpSync, readdirSync, readFileSync, symlinkSync } from "node:fs";
import { delimiter, join } from "node:path";
import { before, test } from "node:test";
import { segmentation, writeBop } from "../support/bop.js";
import { files, folder, pixels, run, shell, writeCase } from "../support/command-line.js";
import { commandLine, installDir, repository } from "../support/environment.js";
import { glb, npy, obj, png, writeFiles } from "../support/files.js";
import { frameAt, frameFiles } from "../support/rig.js";
import { sam3dFiles } from "../support/sam3d.js";
import { mesh, poseJson, truth, view } from "../support/scene.js";
import { masks, poses, standingGlb, tableFiles, tableView } from "../support/table.js";
import { deflated, zip } from "../support/zip.js";

const skip = process.platform === "win32" ? "the examples are for a POSIX shell" : false;
const { width, height, depth } = view;

/** Frames whose cameras are known only through the object. */
function writeFrames(name: string, angles: readonly number[]): void {
  writeCase(name, { "mesh.glb": glb(mesh) });
  for (const [k, angle] of angles.entries()) writeCase(`${name}/frame_0${k}`, frameFiles(frameAt(angle)));
}

const bop = (path: string) => join(folder, "bop", path);
// As much of jq as the examples use.
const follow = `process.argv[1].slice(1).split(".").reduce((value, key) => value[key], JSON.parse(fs.readFileSync(0)))`;

before(async () => {
  symlinkSync(join(installDir, "node_modules"), join(folder, "node_modules"));
  const depthFile = npy(depth, height, width);
  const millimetres = Uint16Array.from(depth, (z) => Math.round(1000 * z));
  for (const name of ["cases/mug", "cases/pan", "mug", "target/cases/cases/lmo/one"]) {
    writeCase(name, { ...files, "gt.json": poseJson(truth) });
  }
  writeFrames("views/mug", [0, 40]);
  writeFrames("videos/mug", [0, 3]);
  writeCase("scenes/desk", tableFiles(1));
  const tableMask = png(masks[0] as Uint8Array, tableView.width, tableView.height);
  const object = { name: "thing-0", mask: tableMask, glb: standingGlb, pose: poses[0] as (typeof poses)[0] };
  writeCase("outputs/desk", sam3dFiles(tableView, [object]));
  writeBop(bop("lmo"));
  const detection = { scene_id: 2, image_id: 3, category_id: 3, score: 0.9, time: 0.5 };
  const archive = zip([deflated("depth.npy", depthFile)]);
  writeFiles(folder, {
    ...{ "annotated.json": poseJson(truth), "d.npy": depthFile, "depth.npy": depthFile },
    ...{ "moge.npz": archive, "depth.npz": archive, "d.png": png(millimetres, width, height) },
    ...{ "m.png": pixels, "mask.png": pixels, "mug.glb": glb(mesh), "mug.obj": obj(mesh) },
    // Formats are told by the content.
    "photo.jpg": png(new Uint8Array(3 * width * height).fill(90), width, height, 3),
    // A target is enough.
    "bop/lmo/test_targets_bop19.json": [{ scene_id: 2, im_id: 3, obj_id: 3, inst_count: 1 }],
    "cnos_lmo-test.json": [{ ...detection, segmentation: await segmentation("000002/mask_visib/000003_000000.png") }],
    "bin/sim3align": `#!/bin/sh\nexec "${process.execPath}" "${commandLine}" "$@"\n`,
    "bin/npx": `#!/bin/sh\nexec "$@"\n`,
    "bin/jq": `#!/bin/sh\nexec "${process.execPath}" -p '${follow}' "$1"\n`,
  });
  for (const name of ["sim3align", "npx", "jq"]) chmodSync(join(folder, "bin", name), 0o755);
  for (const name of ["ycbv", "tless"]) cpSync(bop("lmo"), bop(name), { recursive: true });
  cpSync(bop("tless/test"), bop("tless/test_primesense"), { recursive: true });
  cpSync(bop("tless/models"), bop("tless/models_cad"), { recursive: true });
  cpSync(bop("lmo/models"), bop("models"), { recursive: true });
  cpSync(bop("lmo/test/000003"), bop("test/000048"), { recursive: true });
});

/** The commands by where they stand; each once. */
const commands = new Map<string, string>();
const add = (command: string, place: string) => {
  const plain = command.replace(/ +#.*/, "").replace(/^npx /, "").trim();
  if (!commands.has(plain)) commands.set(plain, place);
};
const flags = new Set<string>();
const helps = ["", "align", "scene", "track", "evaluate", "bop"].map((command) => {
  const help = run(...(command === "" ? [] : [command]), "--help").stdout;
  for (const [, flag = ""] of help.matchAll(/^ {2}(?:-\w, )?(--[\w-]+)/gm)) flags.add(flag);
  const lines = (/\nExamples\n((?: {2}.*\n)+)/.exec(help)?.[1] ?? "").trimEnd().split("\n");
  // In the first text, explanations follow.
  const examples = lines.map((line) => line.trim().split(/ {3,}/)[0] as string);
  for (const example of examples) add(example, `sim3align ${command} --help`);
  return { command, examples };
});
const guides = readdirSync(join(repository, "docs", "guides")).map((name) => join("docs", "guides", name));
/** Flags that documents name, and no command has. */
const unknown: string[] = [];
// Of compilers and of other programs.
const others = ["--allow-read", "--external", "--loader", "--save-numpy", "--strict"];
for (const document of ["README.md", ...guides]) {
  const text = readFileSync(join(repository, document), "utf8");
  // Variables of style sheets begin as flags do.
  const named = text.replace(/^### Style\n.*?^## /ms, "").matchAll(/`(--[a-z][\w-]*)/g);
  const missing = [...named].filter(([, flag = ""]) => !flags.has(flag) && !others.includes(flag));
  unknown.push(...missing.map(([, flag]) => `${document}: ${flag}`));
  for (const [, command = ""] of text.matchAll(/^ {4}(npx sim3align .*)$/gm)) add(command, document);
}

test("every help text has examples of its command", () => {
  for (const { command, examples } of helps) {
    assert.ok(examples.length >= 3, command);
    for (const example of examples) assert.match(example, new RegExp(`sim3align ${command}`));
  }
});

test("the first alignment, as written, from an empty folder", { skip }, () => {
  const guide = readFileSync(join(repository, "docs", "guides", "first-alignment.md"), "utf8");
  const lines =
    /(?:^ {4}.*\n)+/m
      .exec(guide)?.[0]
      .split("\n")
      .map((line) => line.trim()) ?? [];
  // The package is installed already: no registry is asked.
  const install = lines.indexOf("npm install sim3align");
  assert.ok(install > 0);
  const env = { ...process.env, PATH: `${join(folder, "bin")}${delimiter}${process.env.PATH}` };
  lines[install] = `ln -s '${join(installDir, "node_modules")}' node_modules`;
  const { status, stdout, stderr } = shell(lines.filter((line) => line !== "").join(" && "), env);
  assert.equal(status, 0, stderr);
  assert.ok(Number(/confidence +([\d.]+)/.exec(stdout)?.[1]) >= 0.9, stdout);
});

test("the flags that documents name are flags of a command", () => assert.deepEqual(unknown, []));

for (const [command, place] of commands) {
  test(`${place}: ${command}`, { skip }, () => {
    const env = { ...process.env, PATH: `${join(folder, "bin")}${delimiter}${process.env.PATH}` };
    const { status, stdout, stderr } = shell(command, env);
    assert.equal(status, 0, stderr);
    assert.ok((stdout + stderr).trim() !== "", "it prints something");
    if (command.includes("jq")) assert.ok(Number(stdout) > 0, stdout);
  });
}
