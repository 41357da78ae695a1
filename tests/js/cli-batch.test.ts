/** Many cases on the command line: results that come as cases finish, and what is refused before the first one. */
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { existsSync, mkdirSync, symlinkSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import {
  endless,
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
import { commandLine } from "../support/environment.js";
import { poseJson, truth } from "../support/scene.js";

const gt = poseJson(truth);
for (const name of ["one", "two", "three"]) writeCase(name, { ...files, "gt.json": gt });
writeCase("empty", {});

const quick = ["--quality", "fast"];
/** In the order of the command line. */
const inOrder = [...quick, "--workers", "1"];

for (const signal of ["SIGINT", "SIGTERM"] as const) {
  test(`${signal} after two of four cases: their rows and their JSON are there`, async () => {
    const names = ["one", "two", endless(`endless-${signal}`), "three"];
    writeFileSync(join(folder, "part.json"), "{}\n");
    const ended = await interrupted(/^two .*\n/m, signal, "align", ...names, ...inOrder, "--json", "part.json");
    assert.equal(ended.signal, signal, ended.stderr);
    assert.deepEqual(Object.keys(results("part.json")), ["one", "two"]);
    assert.ok(results("part.json").two.errors.scaleError < 0.05);
    assert.match(ended.stderr, /interrupted: 2 of 4 cases are done; they are in part\.json/);
    assert.match(ended.stdout, /^case .*Δrot °.*\none .*\ntwo .*\n/);
    const stdout = await interrupted(/never/, signal, "align", "one", "--json", "-", ...quick);
    assert.equal(stdout.signal, null, "nothing interrupts a run that ends");
  });
}

test("an interruption before the first result leaves the file as it was", async () => {
  writeFileSync(join(folder, "old.json"), "{}\n");
  const child = spawn(process.execPath, [commandLine, "align", endless("never"), "--json", "old.json"], {
    cwd: folder,
  });
  // The signal ends the program at any time.
  const ended = new Promise((resolve) => child.on("close", (_, signal) => resolve(signal)));
  child.on("spawn", () => child.kill("SIGINT"));
  assert.equal(await ended, "SIGINT");
  assert.equal(read("old.json"), "{}\n");
});

test("the JSON of many cases is the text that JSON.stringify writes", () => {
  const { status } = run("align one empty two", ...inOrder, "--json", "many.json");
  assert.equal(status, 1);
  const text = read("many.json");
  assert.equal(text, `${JSON.stringify(JSON.parse(text), null, 2)}\n`);
  const { stdout } = run("align one empty two", ...inOrder, "--json", "-");
  assert.deepEqual(Object.keys(JSON.parse(stdout)), ["one", "empty", "two"]);
});

test("the JSON is written to pipes, too", () => {
  const command = `"${process.execPath}" "${commandLine}" align one two --quality fast --workers 1 --json /dev/fd/3 3>&1 >/dev/null | cat`;
  const { stdout, stderr } = spawnSync("sh", ["-c", command], { cwd: folder, encoding: "utf8" });
  assert.deepEqual(Object.keys(JSON.parse(stdout)), ["one", "two"], stderr);
});

test("a file that cannot be written is noticed before the first case", () => {
  mkdirSync(join(folder, "folder"), { recursive: true });
  for (const flag of ["align one two --json", "evaluate one --json", "align one two --jsonl", "align one two --csv"]) {
    refusesUsage({
      [`${flag} nowhere/out`]: /--\w+ nowhere.out: the file cannot be written: .*no such/,
      [`${flag} folder`]: /--\w+ folder: this is a folder/,
      [`${flag} one/mask.png/out.json`]: /cannot be written/,
    });
  }
  assert.ok(!existsSync(join(folder, "nowhere")));
});

test("a case that is given twice is aligned once, with a message", () => {
  const given = ["one", "./one/", "two", join(folder, "two")];
  const { stdout, stderr } = succeeds("align", ...given, ...inOrder, "--json", "twice.json");
  assert.deepEqual(Object.keys(results("twice.json")), ["one", "two"]);
  assert.match(stderr, /skipped, given twice: \.\/one\/, .*two/);
  assert.equal(stdout.trimEnd().split("\n").length, 3, "the headings and two rows");
});

test("links to one folder are cases of their own: a folder of links is a data set", () => {
  mkdirSync(join(folder, "links"));
  for (const name of ["first", "second"]) symlinkSync(join("..", "one"), join(folder, "links", name));
  succeeds("align links/* one", ...inOrder, "--json", "links.json");
  assert.deepEqual(Object.keys(results("links.json")), ["first", "second", "one"]);
  assert.equal(
    run("align links/**", ...inOrder, "--csv", "-")
      .stdout.trimEnd()
      .split("\n").length,
    3,
  );
});

test("a reader that closes stdout ends the run, unless there is JSON to write", () => {
  const sh = (command: string) => spawnSync("sh", ["-c", command], { cwd: folder, encoding: "utf8" });
  const program = `"${process.execPath}" "${commandLine}" align one two three empty --quality fast --workers 1`;
  assert.match(sh(`${program} | head -n 1`).stdout, /^case .*\n$/);
  sh(`${program} --json closed.json | head -n 1`);
  assert.deepEqual(Object.keys(results("closed.json")), ["one", "two", "three", "empty"]);
});
