/** The commands of help texts and documents: each fits the flags of its command, and six run as they are written. */
import assert from "node:assert/strict";
import { chmodSync, readdirSync, readFileSync, symlinkSync } from "node:fs";
import { delimiter, join } from "node:path";
import { before, test } from "node:test";
import { files, folder, run, shell, writeCase } from "../support/command-line.js";
import { commandLine, installDir, repository } from "../support/environment.js";
import { glb, png, writeFiles } from "../support/files.js";
import { frameAt, frameFiles } from "../support/rig.js";
import { mesh, view } from "../support/scene.js";
import { tableFiles } from "../support/table.js";

const skip = process.platform === "win32" ? "the examples are for a POSIX shell" : false;

/** The flags in a help text, with what follows their names: ` <file>  write the results …`. */
function flagsOf(help: string): Map<string, string> {
  // Sections on output, further down, begin lines with flags as well.
  const [list = ""] = help.split(/\n(?:Batches|Depth of models|Output|Examples)\n/);
  const found = list.matchAll(/^ {2}(?:-\w, )?(--[\w-]+)(.*(?:\n {6,}.*)*)/gm);
  return new Map(Array.from(found, ([, flag = "", rest = ""]) => [flag, rest]));
}

const commandNames = ["", "align", "check", "scene", "track", "evaluate", "serve", "bop"];
const helps = new Map(commandNames.map((name) => [name, run(name, "--help").stdout]));
const flags = new Map([...helps].map(([name, help]) => [name, flagsOf(help)]));
// Flags of the baseline are in a text of their own.
for (const [flag, rest] of flagsOf(run("align --help paper").stdout)) flags.get("align")?.set(flag, rest);

/** The commands, each once, with the place where it stands. */
const commands = new Map<string, string>();
const add = (command: string, place: string) => {
  const plain = command.replace(/ +#.*/, "").replace(/^npx /, "").trim();
  if (!commands.has(plain)) commands.set(plain, place);
};

const examples = new Map<string, string[]>();
for (const [name, help] of helps) {
  const lines = (/\nExamples\n((?: {2}.*\n)+)/.exec(help)?.[1] ?? "").trimEnd().split("\n");
  // In the first text, explanations follow.
  const found = lines.map((line) => line.trim().split(/ {3,}/)[0] as string);
  examples.set(name, found);
  for (const example of found) add(example, `sim3align ${name} --help`);
}

const guides = readdirSync(join(repository, "docs", "guides")).map((name) => join("docs", "guides", name));
/** Flags that documents name, and no command has. */
const unknown: string[] = [];
// Of compilers and of other programs.
const others = ["--allow-read", "--external", "--loader", "--save-numpy", "--strict"];
for (const document of ["README.md", ...guides]) {
  const text = readFileSync(join(repository, document), "utf8");
  // Variables of style sheets begin as flags do.
  const named = text.replace(/^### Style\n.*?^## /ms, "").matchAll(/`(--[a-z][\w-]*)/g);
  for (const [, flag = ""] of named) {
    const isFlag = others.includes(flag) || [...flags.values()].some((of) => of.has(flag));
    if (!isFlag) unknown.push(`${document}: ${flag}`);
  }
  for (const [, command = ""] of text.matchAll(/^ {4}(npx sim3align .*)$/gm)) add(command, document);
}

/** The reasons why the command line would refuse a command. */
function faultsOf(command: string): string[] {
  const own = command.split(" | ").find((part) => part.startsWith("sim3align ")) ?? "";
  const [, name = "", ...words] = (own.match(/'[^']*'|\S+/g) ?? []).map((word) => word.replace(/^'|'$/g, ""));
  const known = flags.get(name);
  if (name === "" || known === undefined) return [`no command ${name}`];
  const faults: string[] = [];
  for (const [i, flag] of words.entries()) {
    if (!flag.startsWith("--")) continue;
    const rest = known.get(flag);
    const value = words[i + 1]?.startsWith("--") ? undefined : words[i + 1];
    const choices = /\(choices: ([^)]*)\)/.exec(rest?.replace(/\s+/g, " ") ?? "")?.[1];
    if (rest === undefined) faults.push(`${name} has no ${flag}`);
    else if (/^ </.test(rest) && value === undefined) faults.push(`${flag} has no value`);
    else if (choices !== undefined && !choices.includes(`"${value}"`)) faults.push(`${flag} is one of ${choices}`);
  }
  return faults;
}

test("every help text has examples of its command", () => {
  for (const [name, found] of examples) {
    assert.ok(found.length >= 3, name);
    for (const example of found) assert.match(example, new RegExp(`sim3align ${name}`));
  }
});

test("the flags that documents name are flags of a command", () => assert.deepEqual(unknown, []));

test("the commands of help texts and documents fit the flags of their commands", () => {
  const faults = [...commands].flatMap(([command, place]) =>
    faultsOf(command).map((why) => `${place}: ${command}: ${why}`),
  );
  assert.deepEqual(faults, []);
});

before(() => {
  symlinkSync(join(installDir, "node_modules"), join(folder, "node_modules"));
  for (const name of ["cases/mug", "cases/pan"]) writeCase(name, files);
  writeCase("scenes/desk", tableFiles(1));
  writeCase("videos/mug", { "mesh.glb": glb(mesh) });
  for (const [k, angle] of [0, 3].entries()) writeCase(`videos/mug/frame_0${k}`, frameFiles(frameAt(angle)));

  // As much of jq as the examples use.
  const follow = `process.argv[1].slice(1).split(".").reduce((value, key) => value[key], JSON.parse(fs.readFileSync(0)))`;
  const { width, height } = view;
  writeFiles(folder, {
    ...{ "depth.npy": files["depth.npy"], "mask.png": files["mask.png"], "mug.glb": glb(mesh) },
    // Formats are told by the content.
    "photo.jpg": png(new Uint8Array(3 * width * height).fill(90), width, height, 3),
    "bin/sim3align": `#!/bin/sh\nexec "${process.execPath}" "${commandLine}" "$@"\n`,
    "bin/npx": `#!/bin/sh\nexec "$@"\n`,
    "bin/jq": `#!/bin/sh\nexec "${process.execPath}" -p '${follow}' "$1"\n`,
  });
  for (const name of ["sim3align", "npx", "jq"]) chmodSync(join(folder, "bin", name), 0o755);
});

/** Runs a line of a shell, which has to succeed, and returns what it printed. */
function runs(line: string): string {
  const env = { ...process.env, PATH: `${join(folder, "bin")}${delimiter}${process.env.PATH}` };
  const { status, stdout, stderr } = shell(line, env);
  assert.equal(status, 0, stderr);
  return stdout;
}

test("the first alignment, as written, from an empty folder", { skip }, () => {
  const guide = readFileSync(join(repository, "docs", "guides", "first-alignment.md"), "utf8");
  const block = /(?:^ {4}.*\n)+/m.exec(guide)?.[0] ?? "";
  const lines = block.split("\n").map((line) => line.trim());
  // The package is installed already: no registry is asked.
  const install = lines.indexOf("npm install sim3align");
  assert.ok(install > 0);
  lines[install] = `ln -s '${join(installDir, "node_modules")}' node_modules`;
  const stdout = runs(lines.filter((line) => line !== "").join(" && "));
  assert.ok(Number(/confidence +([\d.]+)/.exec(stdout)?.[1]) >= 0.9, stdout);
});

for (const command of [
  "sim3align align 'cases/**' --jsonl results.jsonl --resume --report report",
  "find cases -name mesh.glb -printf '%h\\n' | sim3align align --list - --workers 4 --jsonl -",
  `sim3align align cases/mug --preset paper --options '{"fpfhRadiusVoxels": 4}' --json - | jq .mug.scale`,
  "sim3align align photo.jpg --depth depth.npy --mask mask.png --mesh mug.glb --depth-kind affine-invariant-disparity",
  "sim3align scene scenes/desk --json desk.json --scene-glb desk.glb",
  "sim3align track videos/mug --json poses.json",
]) {
  test(command, { skip }, () => {
    assert.ok(commands.has(command), "a help text or a document has it");
    const stdout = runs(command);
    assert.notEqual(stdout.trim(), "");
    if (command.includes("jq")) assert.ok(Number(stdout) > 0, stdout);
  });
}
