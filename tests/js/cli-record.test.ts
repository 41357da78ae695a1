/** Records of batches: a case is its path, whatever its name; one process at a time writes. */
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { existsSync, mkdirSync, renameSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { hostname } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { endless, files, folder, read, refusesUsage, run, writeCase } from "../support/command-line.js";
import { commandLine } from "../support/environment.js";

// Without depth map: their failures are quick, and count as done.
const { "depth.npy": depth, ...incomplete } = files;
const inFolder = (...path: string[]) => join(folder, ...path);
const entries = (record: string) =>
  read(record)
    .trimEnd()
    .split("\n")
    .map((line): { case: string; path: string; content: string } => JSON.parse(line));

/** Runs the command line in a folder. */
function runIn(place: string, ...args: string[]) {
  const options = { cwd: inFolder(place), encoding: "utf8" } as const;
  return spawnSync(process.execPath, [commandLine, "align", ...args], options);
}

for (const name of ["left/mug", "right/mug", "left/pan", "right/jar"]) {
  mkdirSync(inFolder(name), { recursive: true });
  writeCase(name, { ...incomplete, "camera.json": { fx: 600, fy: 600, cx: 320, cy: 240, width: name.length } });
}

test("a case is resumed whatever it is called: from other folders, with other cases", () => {
  const record = ["--jsonl", "batch.jsonl", "--resume"];
  run("align left/mug left/pan", ...record);
  assert.deepEqual(
    entries("batch.jsonl")
      .map((entry) => entry.case)
      .sort(),
    ["mug", "pan"],
  );
  const all = run("align left/* right/*", ...record, "--json", "batch.json");
  assert.match(all.stderr, /resumed: 2 of 4/);
  // Cases are recorded in the order in which workers are done with them.
  const added = entries("batch.jsonl")
    .slice(2)
    .map((entry) => entry.case);
  assert.deepEqual(Object.keys(JSON.parse(read("batch.json"))).sort(), ["left/mug", "pan", ...added].sort());
  const beside = runIn("left", "mug", "pan", "../right/mug", "../right/jar", "--jsonl", "../batch.jsonl", "--resume");
  assert.match(beside.stderr, /resumed: 4 of 4/);
  const absolute = run("align", inFolder("left", "mug"), inFolder("right", "..", "right", "mug"), ...record);
  assert.match(absolute.stderr, /resumed: 2 of 2/);
  assert.deepEqual(
    entries("batch.jsonl")
      .map(({ path }) => path)
      .sort(),
    ["left/mug", "left/pan", "right/jar", "right/mug"],
  );
});

test("the record and its cases may move together, and a case alone: its content tells", () => {
  mkdirSync(inFolder("place"));
  for (const name of ["a", "b"])
    writeCase(`place/${name}`, { ...incomplete, "camera.json": { fovYDeg: name.charCodeAt(0) } });
  runIn("place", "a", "b", "--jsonl", "record.jsonl");
  renameSync(inFolder("place"), inFolder("elsewhere"));
  assert.match(runIn("elsewhere", "a", "b", "--jsonl", "record.jsonl", "--resume").stderr, /resumed: 2 of 2/);
  renameSync(inFolder("elsewhere", "a"), inFolder("elsewhere", "renamed"));
  const again = runIn("elsewhere", "renamed", "b", "--jsonl", "record.jsonl", "--resume", "--csv", "-");
  assert.match(again.stderr, /resumed: 2 of 2/);
  assert.match(again.stdout, /^renamed,/m, "the name that it has now");
  // A copy beside the original is another case.
  writeCase("elsewhere/copy", { ...incomplete, "camera.json": { fovYDeg: "b".charCodeAt(0) } });
  assert.match(runIn("elsewhere", "copy", "b", "--jsonl", "record.jsonl", "--resume").stderr, /resumed: 1 of 2/);
});

test("links to one folder are resumed one by one", () => {
  mkdirSync(inFolder("links"));
  for (const name of ["x", "y", "z"]) symlinkSync(join("..", "left", "mug"), inFolder("links", name));
  run("align links/x links/y --jsonl links.jsonl");
  assert.match(run("align links/* --jsonl links.jsonl --resume").stderr, /resumed: 2 of 3/);
  assert.deepEqual(
    entries("links.jsonl")
      .map(({ path }) => path)
      .sort(),
    ["links/x", "links/y", "links/z"],
  );
});

test("a second process is refused while the first one writes, and may go on after it was killed", async () => {
  const args = ["align", "left/pan", endless("endless"), "--jsonl", "two.jsonl", "--resume", "--workers", "2"];
  const first = spawn(process.execPath, [commandLine, ...args], { cwd: folder });
  const ended = new Promise((resolve) => first.on("close", resolve));
  await new Promise((resolve) => first.stdout.once("data", resolve));
  const message = `--jsonl two\\.jsonl: process ${first.pid} writes this record since .*two\\.jsonl\\.lock`;
  refusesUsage({ [args.join(" ")]: new RegExp(message) });
  first.kill("SIGKILL");
  await ended;
  assert.ok(existsSync(inFolder("two.jsonl.lock")));
  rmSync(inFolder("endless"), { recursive: true });
  writeCase("endless", incomplete);
  assert.match(run(...args).stderr, /resumed: 1 of 2/);
  assert.equal(entries("two.jsonl").length, 2);
  assert.ok(!existsSync(inFolder("two.jsonl.lock")), "the lock ends with the program");
});

test("many processes that begin at once: one of them writes each case once", async () => {
  writeFileSync(inFolder("race.jsonl.lock"), JSON.stringify({ pid: 2 ** 22 + 1, host: hostname(), since: "before" }));
  const args = ["align", "left/*", "right/*", "--jsonl", "race.jsonl", "--resume", "--workers", "1"];
  const statuses = await Promise.all(
    Array.from({ length: 6 }, () => {
      const child = spawn(process.execPath, [commandLine, ...args], { cwd: folder });
      return new Promise<number | null>((resolve) => child.on("close", resolve));
    }),
  );
  assert.ok(statuses.includes(1) && statuses.every((status) => status === 1 || status === 2), `${statuses}`);
  assert.equal(entries("race.jsonl").length, 4);
});

test("a lock of another machine, or of nobody, is refused, and named", () => {
  for (const [content, message] of [
    [JSON.stringify({ pid: 1, host: "elsewhere", since: "2030-01-01" }), /process 1 on elsewhere writes this record/],
    ["rubbish", /held\.jsonl\.lock names no process/],
  ] as const) {
    writeFileSync(inFolder("held.jsonl.lock"), content);
    refusesUsage({ "align left/mug --jsonl held.jsonl": message });
    assert.equal(read("held.jsonl.lock"), content);
  }
});

test("what fails before the first case leaves no lock", () => {
  refusesUsage({ "align left/mug --jsonl free.jsonl --overlay left/mug/camera.json": /./ });
  assert.ok(!existsSync(inFolder("free.jsonl.lock")));
});
