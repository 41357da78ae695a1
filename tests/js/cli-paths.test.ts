/** Which cases a command line names: folders, patterns, lists and stdin. */
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdirSync, symlinkSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { files, folder, refusesUsage, writeCase } from "../support/command-line.js";
import { commandLine } from "../support/environment.js";

// Without depth map: their failures name them at once.
const { "depth.npy": _, ...incomplete } = files;
const cases = ["cases/a1", "cases/a2", "cases/b1", "cases/deep/c1", "odd/[x]", "odd/x"];
mkdirSync(join(folder, "cases", "deep"), { recursive: true });
mkdirSync(join(folder, "odd"), { recursive: true });
for (const name of cases) writeCase(name, incomplete);
mkdirSync(join(folder, "cases", "a1", "textures"));
writeFileSync(join(folder, "cases", "a-file"), "");

/** The names of the cases in a line of JSON each. */
const names = (stdout: string) =>
  stdout
    .split("\n")
    .filter((line) => line !== "")
    .map((line): string => JSON.parse(line).case);

/** The cases that the program finds, in order. */
function found(args: readonly string[], input = ""): string[] {
  const given = ["align", ...args, "--jsonl", "-", "--workers", "1"];
  const { stdout, stderr, status } = spawnSync(process.execPath, [commandLine, ...given], {
    cwd: folder,
    encoding: "utf8",
    input,
  });
  assert.equal(status, 1, stderr);
  return names(stdout);
}

test("a quoted pattern is expanded, in order of the names", () => {
  assert.deepEqual(found(["cases/a*"]), ["a1", "a2"]);
  assert.deepEqual(found(["cases/*1", "cases/a2"]), ["a1", "b1", "a2"]);
  assert.deepEqual(found(["cases/{b,a}1"]), ["a1", "b1"]);
  assert.deepEqual(found(["cases/[ab]1"]), ["a1", "b1"]);
  assert.deepEqual(found([join(folder, "cases", "a*")]), ["a1", "a2"]);
  assert.deepEqual(found(["./cases/../cases/a?/"]), ["a1", "a2"]);
});

test("** finds cases at any depth, and nothing inside of them", () => {
  assert.deepEqual(found(["cases/**"]), ["a1", "a2", "b1", "c1"]);
  assert.deepEqual(found(["**/c*"]), ["c1"]);
});

test("links to folders are found by their names, and no link leads round in a circle", () => {
  mkdirSync(join(folder, "linked", "inner"), { recursive: true });
  symlinkSync(join("..", "cases", "a1"), join(folder, "linked", "first"));
  symlinkSync(join("..", "..", "cases", "a1"), join(folder, "linked", "inner", "second"));
  symlinkSync(join("..", "..", "linked"), join(folder, "linked", "inner", "round"));
  symlinkSync("nowhere", join(folder, "linked", "broken"));
  assert.deepEqual(found(["linked/f*"]), ["first"]);
  assert.deepEqual(found(["linked/**"]), ["first", "second"]);
});

test("a folder whose name looks like a pattern is that folder", () => {
  assert.deepEqual(found(["odd/[x]"]), ["[x]"]);
});

test("a pattern without match is refused", () => {
  refusesUsage({
    "align cases/z*": /cases\/z\*: no folder matches the pattern/,
    "align odd/[x]/**/y": /no folder with a mesh matches the pattern/,
  });
});

test("--list has a path per line; comments and empty lines are skipped, names are taken as they are", () => {
  writeFileSync(join(folder, "list.txt"), "# two of them\ncases/b1\r\n\n  cases/a1  \nodd/[x]\nodd/x");
  assert.deepEqual(found(["--list", "list.txt"]), ["b1", "a1", "[x]", "x"]);
  assert.deepEqual(found(["cases/a*", "--list", "list.txt"]), ["a1", "a2", "b1", "[x]", "x"], "once each");
});

test("--list - reads stdin", () => {
  assert.deepEqual(found(["--list", "-"], "cases/a2\ncases/a1\n"), ["a2", "a1"]);
  const many = Array.from({ length: 3000 }, () => "cases/a1").join("\n");
  assert.deepEqual(found(["--list", "-"], many), ["a1"]);
});

test("a list that is missing, empty, or next to single files is refused", () => {
  writeFileSync(join(folder, "empty.txt"), "# none\n\n");
  refusesUsage({
    "align --list nowhere.txt": /--list nowhere\.txt: the list cannot be read: ENOENT/,
    "align --list cases": /--list cases: the list cannot be read: EISDIR/,
    "align --list empty.txt": /--list: empty\.txt names no case folder/,
    "align --list list.txt --depth d --mask m --mesh m --camera c": /Pass case folders, or --depth/,
  });
});
