/** Batches that are recorded with --jsonl, stopped, and resumed. */
import assert from "node:assert/strict";
import { copyFileSync, existsSync, rmSync, writeFileSync } from "node:fs";
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
import { poseJson, truth } from "../support/scene.js";

const gt = poseJson(truth);
const names = ["a", "b", "c", "d", "e"];
const complete = { ...files, "gt.json": gt };
for (const name of names) writeCase(name, complete);
writeCase("empty", {});
const all = [...names, "empty"];

const quick = ["--quality", "fast"];
const inFolder = (name: string) => join(folder, name);
const linesOf = (path: string) => read(path).split("\n");

/** The entries of a file by case, in the order of the names, without times. */
function entriesOf(path: string): unknown[] {
  const lines = linesOf(path);
  assert.equal(lines.pop(), "", "the last line ends");
  const entries = lines.map((line) => {
    const { timingsMs, ...entry } = JSON.parse(line);
    assert.ok(timingsMs?.total > 0 || entry.error);
    return entry;
  });
  return entries.sort((x, y) => (x.case < y.case ? -1 : 1));
}

/** The rows of a table by case, in the order of the names, without times. */
function rowsOf(path: string): string[] {
  const [head, ...rows] = linesOf(path).map((line) => line.replace(/,[^,]*$/, ""));
  assert.equal(rows.pop(), "");
  return [head ?? "", ...rows.sort()];
}

/** A complete batch, which others are compared with. */
const whole = run("align", ...all, ...quick, "--jsonl", "whole.jsonl", "--csv", "whole.csv", "--json", "whole.json");

test("--jsonl has a line for each case, the entry of --json", () => {
  assert.equal(whole.status, 1, whole.stderr);
  assert.equal(linesOf("whole.jsonl").length, all.length + 1);
  const json = results("whole.json");
  for (const line of linesOf("whole.jsonl").slice(0, -1)) {
    const { case: name, path, content, ...entry } = JSON.parse(line);
    assert.deepEqual(entry, json[name], name);
    assert.equal(path, name, "relative to the record");
    assert.equal(typeof content, name === "empty" ? "undefined" : "string");
  }
  assert.deepEqual(Object.keys(json).sort(), all);
});

test("--csv has the numbers of --json, a row for each case", () => {
  const [head = [], ...rows] = linesOf("whole.csv").map((line) => line.split(","));
  assert.deepEqual(rows.pop(), [""]);
  assert.equal(rows.length, all.length);
  const json = results("whole.json");
  for (const row of rows) {
    const cells = Object.fromEntries(head.map((heading, i) => [heading, row[i]]));
    const { error, scale, confidence, translation, quaternion, metrics, errors, alternatives } = json[cells.case ?? ""];
    assert.equal(row.length, head.length);
    assert.equal(cells.error, error?.code ?? "");
    if (error !== undefined) continue;
    const [tx, ty, tz, w] = [cells.txM, cells.tyM, cells.tzM, cells.qw].map(Number);
    assert.deepEqual([tx, ty, tz, w], [...translation, quaternion[3]]);
    assert.deepEqual([cells.scale, cells.confidence, cells.iou].map(Number), [scale, confidence, metrics.iou]);
    assert.equal(Number(cells.rotationErrorDeg), errors.rotationErrorDeg);
    assert.equal(Number(cells.alternatives), alternatives.length);
  }
});

test("a case whose name needs quotes has them in the CSV", () => {
  writeCase('x, "y"', {});
  run("align", 'x, "y"', "empty", "--csv", "quoted.csv", "--workers", "1");
  assert.match(read("quoted.csv"), /^case,error,.*\n"x, ""y""",FILE_NOT_FOUND,/);
});

for (const workers of ["1", "2"]) {
  test(`a batch of ${workers} workers that is killed and resumed gives the same files`, async () => {
    const record = ["--jsonl", `killed-${workers}.jsonl`, "--csv", `killed-${workers}.csv`];
    const args = ["align", ...all, ...quick, "--workers", workers, ...record];
    // A case that never ends: the batch is killed in its middle.
    rmSync(inFolder("d"), { recursive: true });
    endless("d");
    const killed = await interrupted(/^[abc] .*\n[abc] .*\n/m, "SIGKILL", ...args);
    rmSync(inFolder("d"), { recursive: true });
    writeCase("d", complete);
    assert.equal(killed.signal, "SIGKILL", killed.stderr);
    const before = linesOf(`killed-${workers}.jsonl`).length - 1;
    assert.ok(before >= 2 && before < 6, `${before} lines were there`);
    const { status, stderr, stdout } = run(...args, "--resume", "--json", `killed-${workers}.json`);
    assert.equal(status, 1, "a case has failed, if not in this run");
    assert.match(stderr, new RegExp(`resumed: ${before} of 6 cases are in killed-${workers}.jsonl`));
    assert.equal(stdout.match(/^([a-e]|empty) /gm)?.length, 6 - before, "no case is aligned twice");
    assert.deepEqual(entriesOf(`killed-${workers}.jsonl`), entriesOf("whole.jsonl"));
    assert.deepEqual(rowsOf(`killed-${workers}.csv`), rowsOf("whole.csv"));
    assert.deepEqual(Object.keys(results(`killed-${workers}.json`)).sort(), all);
  });
}

for (const [what, ending] of [
  ["its name", (line: string) => line.slice(0, 5)],
  ["a number", (line: string) => line.slice(0, line.length / 2)],
  ["its line break", (line: string) => line],
] as const) {
  test(`a last line that was cut off after ${what} is repaired`, () => {
    const [first = "", second = ""] = linesOf("whole.jsonl");
    writeFileSync(inFolder("torn.jsonl"), `${first}\n${ending(second)}`);
    const { status, stderr } = run("align", ...all, ...quick, "--jsonl", "torn.jsonl", "--resume");
    assert.equal(status, 1, stderr);
    assert.match(stderr, what === "its line break" ? /resumed: 2 of 6/ : /resumed: 1 of 6/);
    assert.equal(linesOf("torn.jsonl")[0], first, "what is there stays");
    assert.deepEqual(entriesOf("torn.jsonl"), entriesOf("whole.jsonl"));
  });
}

test("lines longer than a block of reading are found and repaired", () => {
  const [first = ""] = linesOf("whole.jsonl");
  const long = JSON.stringify({ case: "elsewhere", text: "ü".repeat(100_000) });
  writeFileSync(inFolder("long.jsonl"), `${long}\n${long.slice(0, -2)}`);
  const { stderr } = run("align a empty", ...quick, "--jsonl", "long.jsonl", "--resume");
  assert.match(stderr, /resumed: 0 of 2/);
  const lines = linesOf("long.jsonl");
  assert.equal(lines.length, 4);
  assert.equal(lines[0], long);
  assert.equal(JSON.parse(first).case.length, 1);
});

test("a complete batch that is resumed aligns nothing, and has the same exit status", () => {
  copyFileSync(inFolder("whole.jsonl"), inFolder("complete.jsonl"));
  const { status, stdout, stderr } = run(
    "align",
    ...all,
    "--jsonl",
    "complete.jsonl",
    "--resume",
    "--csv",
    "again.csv",
  );
  assert.equal(status, 1);
  assert.equal(stdout, "");
  assert.match(stderr, /resumed: 6 of 6/);
  assert.match(stderr, /failed earlier: empty \(FILE_NOT_FOUND\); remove their lines/);
  assert.deepEqual(rowsOf("again.csv"), rowsOf("whole.csv"));
  succeeds("align a b --jsonl complete.jsonl --resume");
  assert.deepEqual(linesOf("complete.jsonl"), linesOf("whole.jsonl"));
});

test("--resume without a file begins one", () => {
  succeeds("align a", ...quick, "--jsonl", "begun.jsonl", "--resume");
  assert.equal(linesOf("begun.jsonl").length, 2);
});

test("results are never lost by accident: a file with content needs --resume", () => {
  const text = "the work of a day\n";
  writeFileSync(inFolder("kept.jsonl"), text);
  refusesUsage({ "align a --jsonl kept.jsonl": /--jsonl kept\.jsonl: the file has content\. Pass --resume/ });
  for (const content of [text, text.trimEnd(), `${linesOf("whole.jsonl")[0]}\n${text}`, '{"case": 1}\n']) {
    writeFileSync(inFolder("kept.jsonl"), content);
    refusesUsage({
      "align a --jsonl kept.jsonl --resume": /--jsonl kept\.jsonl: line \d is not an object with "case"/,
    });
    assert.equal(read("kept.jsonl"), content);
  }
});

test("flags that contradict each other are refused", () => {
  refusesUsage({
    "align a b --resume": /--resume needs --jsonl FILE/,
    "align a b --jsonl - --resume": /--resume needs a file/,
    "align a b --jsonl same --csv ./same": /--jsonl and --csv name the same file/,
    "align a b --json - --jsonl -": /--json and --jsonl name the same file/,
    "align a b --workers 0": /Expected 1 to 64, or "auto"/,
    "align a b --workers 1.5": /Expected 1 to 64, or "auto"/,
    "align a b --workers 65": /Expected 1 to 64, or "auto"/,
  });
  assert.ok(!existsSync(inFolder("same")));
});

test("an option that no case can have ends the batch before the next result", () => {
  const { status, stderr } = run("align", ...all, "--mesh-up", "0,0,0", "--jsonl", "none.jsonl", "--workers", "2");
  assert.equal(status, 2, stderr);
  assert.match(stderr, /^error: /m);
  assert.ok(
    !existsSync(inFolder("none.jsonl")) || !linesOf("none.jsonl").some((line) => line.includes("INVALID_OPTION")),
  );
});

test("--jsonl - and --csv - write to stdout as cases end, the table goes to stderr", () => {
  const jsonl = run("align a empty", ...quick, "--jsonl", "-");
  const found = jsonl.stdout.trimEnd().split("\n");
  assert.deepEqual(found.map((line) => JSON.parse(line).case).sort(), ["a", "empty"]);
  assert.match(jsonl.stderr, /^a +\d/m);
  const csv = run("align a empty", ...quick, "--csv", "-");
  assert.match(csv.stdout, /^case,error,confidence,.*\n.*\n.*\n$/);
});

test("stdout has no record: a file of the name - is not read", () => {
  writeFileSync(inFolder("-"), "something else\n");
  const { status, stdout } = run("align empty --jsonl -");
  rmSync(inFolder("-"));
  assert.equal(status, 1);
  assert.equal(JSON.parse(stdout).case, "empty");
});

test("Ctrl-C keeps what is done, says how to go on, and ends the program as the signal does", async () => {
  rmSync(inFolder("stopped.jsonl"), { force: true });
  const args = ["align", "a", "b", endless("endless"), "c", ...quick, "--jsonl", "stopped.jsonl"];
  const stopped = await interrupted(/^[abc] .*\n[abc] .*\n[abc] .*\n/m, "SIGINT", ...args, "--workers", "2");
  assert.equal(stopped.signal, "SIGINT");
  assert.match(stopped.stderr, /interrupted: 3 of 4 cases are done; they are in stopped\.jsonl\n/);
  assert.match(stopped.stderr, /To go on, run the same command with --resume\.\n/);
  assert.equal(entriesOf("stopped.jsonl").length, 3);
  rmSync(inFolder("endless"), { recursive: true });
  writeCase("endless", files);
  assert.match(run(...args, "--resume").stderr, /resumed: 3 of 4/);
  assert.equal(entriesOf("stopped.jsonl").length, 4);
});

test("an interruption without --jsonl tells of it", async () => {
  const args = ["align", "a", endless("endless-alone"), ...quick, "--workers", "2"];
  const { stderr } = await interrupted(/^a .*\n/m, "SIGINT", ...args);
  assert.match(stderr, /interrupted: 1 of 2 cases are done\nWith --jsonl FILE, a batch can be resumed/);
});
