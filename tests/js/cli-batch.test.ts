/** Many cases on the command line: which they are, tables and records of their results, and batches that end early. */
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { existsSync, mkdirSync, renameSync, symlinkSync, truncateSync, utimesSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";
import { test } from "node:test";
import {
  files,
  folder,
  interrupted,
  read,
  refusesUsage,
  results,
  run,
  shell,
  succeeds,
  withFaults,
  writeCase,
} from "../support/command-line.js";
import { commandLine } from "../support/environment.js";
import { glb, gltfBuffer, gltfJson, maskPng } from "../support/files.js";
import { mesh, poseJson, truth } from "../support/scene.js";

const inFolder = (...path: string[]) => join(folder, ...path);
const linesOf = (path: string) => read(path).trimEnd().split("\n");
/** The lines of cases in a record, whose first line has its settings. */
const casesOf = (path: string) => linesOf(path).slice(1);
const quick = ["--quality", "fast"];
const complete = { ...files, "gt.json": poseJson(truth) };
// Without depth map: their failures are quick, and count as done.
const { "depth.npy": _, ...incomplete } = files;

for (const name of ["a", "b", "c", "endless", "held"]) writeCase(name, complete);
writeCase('x, "y"', {});
for (const name of ["cases/a1", "cases/a2", "cases/b1", "cases/deep/c1", "odd/[x]", "odd/x", "order/c9", "order/c10"])
  writeCase(name, incomplete);
mkdirSync(inFolder("cases", "a1", "textures"));
writeFileSync(inFolder("cases", "a-file"), "");
mkdirSync(inFolder("linked", "inner"), { recursive: true });
symlinkSync(join("..", "cases", "a1"), inFolder("linked", "first"));
symlinkSync(join("..", "..", "cases", "a1"), inFolder("linked", "inner", "second"));
symlinkSync(join("..", "..", "linked"), inFolder("linked", "inner", "round"));
symlinkSync("nowhere", inFolder("linked", "broken"));
writeFileSync(inFolder("list.txt"), "# two of them\ncases/b1\r\n\n  cases/a1  \nodd/[x]\nodd/x");

// Names that patterns, terminals and spreadsheets may take for something else.
for (const name of ["a\nb", "u\u2028v", "\u001b[31mred", "=cmd()"]) writeCase(`names/${name}`, incomplete);
const hasBytes = process.platform === "linux";
if (hasBytes) mkdirSync(Buffer.concat([Buffer.from(inFolder("names", "bytes")), Buffer.of(0xff)]));

/** Command lines, and the cases that they name, in order. */
const named: Record<string, string> = {
  "cases/a*": "a1,a2",
  "cases/*1 cases/a2 ./cases/a1/": "a1,b1,a2",
  [inFolder("cases", "a*")]: "a1,a2",
  // At any depth, and nothing inside of a case; no link leads round in a circle.
  "cases/**": "a1,a2,b1,c1",
  "linked/f*": "first",
  "linked/**": "first,second",
  "names/**": "\\u001b[31mred,=cmd(),a\\nb,u\u2028v",
  "names/[!=]*": "\\u001b[31mred,a\\nb,u\u2028v",
  "{cases,names}/[a-c][1-9\n]*": "a1,a2,b1,a\\nb",
  "odd/[x]": "[x]",
  "order/c*": "c9,c10",
  "cases/a* --list list.txt": "a1,a2,b1,[x],x",
  "--list -": "a2,a1",
};

test("cases are named by folders, patterns, lists and stdin", () => {
  const input = `cases/a2\n${"cases/a1\n".repeat(3000)}`;
  for (const [words, names] of Object.entries(named)) {
    const all = [commandLine, "align", ...words.split(" "), "--jsonl", "-", "--workers", "1"];
    const { stdout, stderr } = spawnSync(process.execPath, all, { cwd: folder, encoding: "utf8", input });
    assert.equal(stdout.match(/(?<=^{"case":")[^"]+/gm)?.join(), names, `${words}: ${stderr}`);
  }
  const { stdout, stderr } = run("align cases/a1 ./cases/a1/ cases/a2 --json twice.json");
  assert.match(stderr, /skipped, given twice: \.\/cases\/a1\//);
  assert.equal(stdout.match(/^a[12] /gm)?.length, 2);
  writeCase("other/a1", incomplete);
  run("align cases/a1 other/a1 --workers 1 --json names.json");
  assert.deepEqual(Object.keys(results("names.json")), ["cases/a1", "other/a1"], "one name: by their paths");
});

test("names are printed without control characters, and are no formulas in CSV; those that are no text are named", () => {
  const { stdout, stderr } = run("align names/* --workers 1 --csv names.csv");
  assert.match(stdout, /^\\u001b\[31mred .*FILE_NOT_FOUND\n=cmd\(\) .*\na\\nb .*\nu\\u2028v /m);
  for (const control of ["\u001b", "\u2028"]) assert.ok(!`${stdout}${stderr}`.includes(control));
  if (hasBytes) assert.match(stderr, /skipped, cannot be read: names.bytes\ufffd \(its name is no UTF-8\)/);
  assert.match(read("names.csv"), /^'=cmd\(\),FILE_NOT_FOUND/m);
});

/** The entries of a record by case, without times. */
function entriesOf(path: string): { case: string; path: string }[] {
  const entries = casesOf(path).map((line) => JSON.parse(line));
  for (const entry of entries) delete entry.diagnostics?.timingsMs;
  return entries.sort((x, y) => (x.case < y.case ? -1 : 1));
}

/** The rows of a table by case, without times. */
const rowsOf = (path: string) =>
  linesOf(path)
    .map((line) => line.replace(/,[^,]*$/, ""))
    .sort();

const all = ["a", "b", "c", 'x, "y"'];
const whole = run("align", ...all, ...quick, "--jsonl", "whole.jsonl", "--csv", "whole.csv", "--json", "whole.json");

test("--jsonl has a line for each case, the entry of --json; --csv its numbers", () => {
  assert.equal(whole.status, 1, whole.stderr);
  const json = results("whole.json");
  assert.deepEqual([Object.keys(json).sort(), casesOf("whole.jsonl").length], [all, all.length]);
  for (const line of casesOf("whole.jsonl")) {
    const { case: name, path, files, content, ...entry } = JSON.parse(line);
    assert.deepEqual([{ path, ...entry }, path], [json[name], name]);
    assert.equal(typeof content, name.startsWith("x") ? "undefined" : "string");
    assert.equal("depth.npy" in (files ?? {}), typeof content === "string");
  }
  const [head = [], ...rows] = linesOf("whole.csv").map((line) => line.split(","));
  assert.match(read("whole.csv"), /^case,error,confidence,.*\n(.*\n)*"x, ""y""",FILE_NOT_FOUND,/);
  for (const row of rows.filter(([name]) => name?.length === 1)) {
    const cells = Object.fromEntries(head.map((heading, i) => [heading, row[i]]));
    const { scale, confidence, translation, rotation, metrics, errors, alternatives } = json[cells.case ?? ""];
    const { txM, tyM, tzM, qw, iou, rotationErrorDeg } = cells;
    const found = [txM, tyM, tzM, qw, cells.scale, cells.confidence, iou, rotationErrorDeg, cells.alternatives];
    const expected = [...translation, rotation[3], scale, confidence, metrics.iou, errors.rotationErrorDeg];
    assert.deepEqual(found.map(Number), [...expected, alternatives.length]);
  }
});

test("a batch that is killed and resumed gives the same files, with any number of workers", async () => {
  for (const workers of ["1", "2"]) {
    const record = ["--jsonl", `killed-${workers}.jsonl`, "--csv", `killed-${workers}.csv`, "--workers", workers];
    const args = ["align", ...all, ...quick, ...record];
    // A case that never ends: the batch is killed in its middle.
    const restore = withFaults({ hanging: "c" });
    const killed = await interrupted(/^[ab] .*\n[ab] .*\n/m, "SIGKILL", ...args).finally(restore);
    assert.equal(killed.signal, "SIGKILL", killed.stderr);
    const before = casesOf(`killed-${workers}.jsonl`).length;
    const { status, stderr, stdout } = run(...args, "--resume", "--json", `killed-${workers}.json`);
    assert.equal(status, 1, "a case has failed, if not in this run");
    assert.match(stderr, new RegExp(`resumed: ${before} of 4 cases are in killed-${workers}.jsonl`));
    assert.equal(stdout.match(/^([abc]|x,) /gm)?.length, 4 - before, "no case is aligned twice");
    assert.deepEqual(entriesOf(`killed-${workers}.jsonl`), entriesOf("whole.jsonl"));
    assert.deepEqual(rowsOf(`killed-${workers}.csv`), rowsOf("whole.csv"));
    assert.deepEqual(Object.keys(results(`killed-${workers}.json`)).sort(), all);
  }
});

test("a last line that was cut off is repaired, however long it is; a complete batch is not aligned again", () => {
  const [settings = "", first = "", second = ""] = linesOf("whole.jsonl");
  const long = JSON.stringify({ case: "elsewhere", text: "ü".repeat(100_000) });
  const torn: [text: string, resumed: number][] = [
    [`${settings}\n${first}\n${second.slice(0, 5)}`, 1],
    [`${settings}\n${first}\n${second}`, 2],
    // Two records that were joined.
    [`${settings}\n${long}\n${settings}\n${first}\n${long.slice(0, -2)}`, 1],
  ];
  for (const [text, count] of torn) {
    writeFileSync(inFolder("torn.jsonl"), text);
    const { stderr } = run("align", ...all, ...quick, "--jsonl", "torn.jsonl", "--resume");
    assert.match(stderr, new RegExp(`resumed: ${count} of 4`));
    assert.equal(linesOf("torn.jsonl")[0], text.split("\n")[0], "what is there stays");
    const entries = entriesOf("torn.jsonl").filter((entry) => all.includes(entry.case));
    assert.deepEqual(entries, entriesOf("whole.jsonl"));
  }
  const again = run("align", ...all, ...quick, "--jsonl", "whole.jsonl", "--resume", "--csv", "again.csv");
  assert.deepEqual([again.status, again.stdout], [1, ""]);
  assert.match(again.stderr, /resumed: 4 of 4.*failed earlier: x, "y" \(FILE_NOT_FOUND\); remove their lines/s);
  assert.deepEqual(rowsOf("again.csv"), rowsOf("whole.csv"));
});

test("a case that has moved is resumed by its content", () => {
  for (const [name, fovYDeg] of [
    ["m1", 41],
    ["m2", 42],
  ] as const) {
    writeCase(`place/${name}`, { ...files, "camera.json": { fovYDeg } });
  }
  succeeds("align place/m1 place/m2 --quality fast --jsonl place/record.jsonl");
  renameSync(inFolder("place"), inFolder("elsewhere"));
  renameSync(inFolder("elsewhere", "m1"), inFolder("elsewhere", "renamed"));
  const again = run(
    "align elsewhere/renamed elsewhere/m2 --jsonl elsewhere/record.jsonl --resume --csv - --quality fast",
  );
  assert.match(again.stderr, /resumed: 2 of 2/);
  assert.match(again.stdout, /^renamed,/m, "the name that it has now");
  // A copy beside the original is another case.
  writeCase("elsewhere/copy", { ...files, "camera.json": { fovYDeg: 42 } });
  const copied = run("align elsewhere/copy elsewhere/m2 --jsonl elsewhere/record.jsonl --resume --quality fast");
  assert.match(copied.stderr, /resumed: 1 of 2/);
});

test("a camera of a flag is part of the settings of a record", () => {
  writeCase("flagged", files);
  const flags =
    "--depth flagged/depth.npy --mask flagged/mask.png --mesh flagged/mesh.glb --jsonl flagged.jsonl --resume";
  succeeds(`align ${flags} --camera fov:42`, ...quick);
  assert.match(succeeds(`align ${flags} --camera fov:42`, ...quick).stderr, /resumed: 1 of 1/);
  refusesUsage({ [`align ${flags} --camera fov:60 --quality fast`]: /flagged\.jsonl/ });
});

test("cases that have changed since are done again, and the last line counts", () => {
  writeCase("loop", files);
  const flags = `${quick.join(" ")} --jsonl loop.jsonl --resume`;
  succeeds(`align loop ${flags}`);
  assert.match(succeeds(`align loop ${flags}`).stderr, /resumed: 1 of 1 cases are in loop\.jsonl\n/);
  const doubled = { "mesh.glb": glb({ ...mesh, positions: mesh.positions.map((x) => 2 * x) }) };
  const changes: Record<string, object> = {
    "another mesh": doubled,
    "a photo that was added": { ...doubled, "rgb.png": maskPng(new Uint8Array(160 * 120), 160, 120) },
    "a true pose that was added": { ...doubled, "gt.json": poseJson(truth) },
    "another true pose": { ...doubled, "gt.json": poseJson({ ...truth, scale: 2 * truth.scale }) },
  };
  for (const [what, changed] of Object.entries(changes)) {
    writeCase("loop", { ...files, ...changed });
    assert.match(succeeds(`align loop ${flags}`).stderr, /0 of 1 .*; 1 changed since, and done again/, what);
    assert.match(succeeds(`align loop ${flags} --json loop.json`).stderr, /resumed: 1 of 1 cases are in loop\.jsonl\n/);
  }
  assert.ok(Math.abs(results("loop.json").loop.scale / truth.scale - 0.5) < 0.02);
  const withoutPhoto = `align loop ${quick.join(" ")} --no-image --jsonl plain.jsonl --resume`;
  succeeds(withoutPhoto);
  assert.match(succeeds(withoutPhoto).stderr, /resumed: 1 of 1 cases are in plain\.jsonl\n/);
});

test("the pose of another mesh is refused, and rows of any length are read or refused", () => {
  writeCase("remade", complete);
  succeeds(`align remade ${quick.join(" ")} --jsonl remade.jsonl`);
  succeeds("evaluate remade --transform remade.jsonl");
  writeCase("remade", { ...complete, "mesh.glb": glb({ ...mesh, positions: mesh.positions.map((x) => 2 * x) }) });
  for (const command of ["evaluate remade --transform", "align remade --quality fast --initial"]) {
    const { status, stdout, stderr } = run(...`${command} remade.jsonl`.split(" "));
    assert.equal(status, 1);
    assert.match(stdout + stderr, /INVALID_TRANSFORM.*a pose of another mesh for remade/, command);
  }

  writeFileSync(inFolder("endless.jsonl"), `${linesOf("remade.jsonl")[0]}\n{"case":"remade`);
  truncateSync(inFolder("endless.jsonl"), 1 << 29);
  const { stdout } = run("evaluate", "remade", "--transform", "endless.jsonl");
  assert.match(stdout, /FILE_TOO_LARGE.*endless\.jsonl: line 2 has more than/);
  refusesUsage({ "align remade --quality fast --jsonl endless.jsonl --resume": /line 2 has more than/ });
});

test("check reads cases without aligning them", () => {
  writeCase("sound", files);
  writeCase("doubtful", { ...files, "mask.png": maskPng(new Uint8Array(160 * 120).fill(1), 160, 120) });
  const { status, stdout } = run("check", "sound", "doubtful", "a", 'x, "y"', "--json", "checked.json");
  assert.equal(status, 1);
  assert.match(stdout, /^sound: can be aligned$/m);
  assert.match(stdout, /^doubtful: .*MASK_COVERS_IMAGE/m);
  assert.match(stdout, /failed x, "y": FILE_NOT_FOUND/);
  const { doubtful, sound } = results("checked.json");
  assert.deepEqual([sound.warnings, doubtful.inputs["mask.png"].as], [[], "mask"]);
  assert.equal(run("check", "sound").status, 0);
});

test("a link out of the folder of a mesh is followed for a mesh, and not for what it refers to", () => {
  const { "mesh.glb": _glb, ...view } = files;
  const gltf = gltfJson(mesh, {}, { uri: "mesh.bin" });
  writeCase("stored", { "mesh.bin": gltfBuffer(mesh), "mesh.gltf": gltf });
  writeCase("escaping", { ...view, "mesh.gltf": gltf });
  writeCase("linking", view);
  const link = (name: string) => symlinkSync(join("..", "stored", basename(name)), inFolder(name));
  for (const name of ["escaping/mesh.bin", "linking/mesh.bin", "linking/mesh.gltf"]) link(name);
  const { stdout } = run("check", "escaping", "linking");
  assert.match(stdout, /failed escaping: FILE_NOT_FOUND.*a link at .*mesh\.bin that leads out of its folder/);
  assert.match(stdout, /^linking: can be aligned$/m);
});

test("a transform is that of the case by its path, not of another one by its name", () => {
  for (const name of ["here/x", "there/x"]) writeCase(name, complete);
  succeeds(`align here/x ${quick.join(" ")} --jsonl here.jsonl --json here.json`);
  for (const file of ["here.jsonl", "here.json"]) {
    succeeds(`evaluate here/x --transform ${file}`);
    const refused = run("evaluate", "there/x", "--transform", file);
    assert.equal(refused.status, 1);
    assert.match(refused.stdout + refused.stderr, /INVALID_TRANSFORM.*here.x, which has the same name/);
  }
  renameSync(inFolder("here"), inFolder("moved"));
  succeeds("evaluate moved/x --transform here.jsonl");
});

test("a record of files has a row for each set of files", () => {
  writeCase("one", { ...files, "other.glb": glb({ ...mesh, positions: mesh.positions.map((x) => 2 * x) }) });
  const align = (name: string) => {
    const inputs = `--depth one/depth.npy --mask one/mask.png --camera one/camera.json --mesh one/${name}`;
    const { stderr } = succeeds(`align ${inputs} ${quick.join(" ")} --jsonl one.jsonl --resume --json one.json`);
    return { stderr, scale: Object.values(results("one.json")).map((entry) => (entry as { scale: number }).scale) };
  };
  const [first] = [align("mesh.glb")];
  assert.doesNotMatch(align("other.glb").stderr, /1 of 1/);
  const again = align("mesh.glb");
  assert.match(again.stderr, /resumed: 1 of 1/);
  assert.deepEqual(again.scale, first.scale);
  assert.match(align("other.glb").stderr, /resumed: 1 of 1/);
  assert.equal(casesOf("one.jsonl").length, 2);
});

test("a signal keeps what is done, says how to go on, and ends the program as the signal does", async () => {
  for (const signal of ["SIGINT", "SIGTERM"] as const) {
    const record = `${signal}.jsonl`;
    const args = ["align", "a", "b", "endless", "c", ...quick, "--workers", "1"];
    const outputs = ["--jsonl", record, "--json", "part.json"];
    writeFileSync(inFolder("part.json"), "{}\n");
    const restore = withFaults({ hanging: "endless" });
    const stopped = await interrupted(/^b .*\n/m, signal, ...args, ...outputs).finally(restore);
    assert.equal(stopped.signal, signal, stopped.stderr);
    assert.match(stopped.stderr, /interrupted: 2 of 4 cases are done; they are in .*SIG/);
    assert.match(stopped.stderr, /To go on, run the same command with --resume\.\n/);
    assert.deepEqual(Object.keys(results("part.json")), ["a", "b"]);
    assert.match(run(...args, ...outputs, "--resume").stderr, /resumed: 2 of 4/);
  }
});

test("one process at a time writes a record; a lock ends with its process, or after five minutes without a mark", async () => {
  const args = ["align", "cases/a1", "held", ...quick, "--jsonl", "two.jsonl", "--resume", "--workers", "2"];
  const restore = withFaults({ hanging: "held" });
  const first = spawn(process.execPath, [commandLine, ...args], { cwd: folder });
  restore();
  const ended = new Promise((resolve) => first.on("close", resolve));
  await new Promise((resolve) => first.stdout.once("data", resolve));
  const held = read("two.jsonl.lock");
  const message = `--jsonl two\\.jsonl: process ${first.pid} writes this record since .*two\\.jsonl\\.lock`;
  refusesUsage({ [args.join(" ")]: new RegExp(message) });
  first.kill("SIGKILL");
  await ended;
  assert.match(run(...args).stderr, /resumed: 1 of 2/);
  assert.ok(!existsSync(inFolder("two.jsonl.lock")), "the lock ends with the program");
  const owner = JSON.parse(held);
  const locks: Record<string, string> = {
    "of another container": JSON.stringify({ ...owner, system: "another" }),
    "of a process whose number is used again": JSON.stringify({ ...owner, pid: process.pid, started: "0" }),
    empty: "",
  };
  for (const [what, text] of Object.entries(locks)) {
    const isOfSystem = what.includes("number");
    if (isOfSystem && owner.started === "") continue;
    writeFileSync(inFolder("two.jsonl.lock"), text);
    if (!isOfSystem) {
      refusesUsage({ [args.join(" ")]: /Its lock ends in \d+ s.*two\.jsonl\.lock/ });
      utimesSync(inFolder("two.jsonl.lock"), 0, 0);
    }
    assert.match(run(...args).stderr, /resumed: 2 of 2/, what);
  }
});

test("results are never lost by accident: a file with other content is not continued or overwritten", () => {
  const text = "the work of a day\n";
  const [settings = "", line = ""] = linesOf("whole.jsonl");
  writeFileSync(inFolder("kept.jsonl"), text);
  refusesUsage({ "align a --jsonl kept.jsonl": /--jsonl kept\.jsonl: the file has content\. Pass --resume/ });
  const older = { ...JSON.parse(settings), sim3align: "0.9.0" };
  const refused: [content: string, message: RegExp][] = [
    [text, /line 1 does not have the version.*another file, or remove/],
    [text.trimEnd(), /line 1 does not have/],
    [`${line}\n`, /line 1 does not have/],
    [`${settings}\n${line}\n${text}`, /line 3 is not an object with "case"/],
    [`${settings}\n{"case": 1}\n`, /line 2 is not/],
    [`${settings}\n${JSON.stringify(older)}\n`, /other settings: version is "[^"]+", was "0\.9\.0"\./],
    [`${settings}\n`.replace("fast", "best"), /other settings: --quality is "fast", was "best"\. Pass another file/],
    [`${settings}\n`.replace('"align"', '"track"'), /other settings: command is "align", was "track"/],
  ];
  for (const [content, message] of refused) {
    writeFileSync(inFolder("kept.jsonl"), content);
    refusesUsage({ "align a --quality fast --jsonl kept.jsonl --resume": message });
    assert.equal(read("kept.jsonl"), content);
  }
});

test("- is stdout, whose table then goes to stderr; pipes that end early end the run", () => {
  const jsonl = run("align a cases/a1 --jsonl -", ...quick);
  assert.deepEqual(jsonl.stdout.match(/(?<=^{"case":")\w+/gm)?.sort(), ["a", "a1"]);
  assert.match(jsonl.stderr, /^a +\d/m);
  assert.match(run("align a cases/a1 --csv -", ...quick).stdout, /^case,error,confidence,.*\n.*\n.*\n$/);
  const program = `"${process.execPath}" "${commandLine}" align cases/a1 cases/a2 cases/b1 --workers 1`;
  assert.match(shell(`${program} | head -n 1`).stdout, /^case .*\n$/);
  shell(`${program} --json closed.json | head -n 1`);
  assert.equal(Object.keys(results("closed.json")).length, 3);
  succeeds("align a --jsonl begun.jsonl --resume", ...quick);
});

test("an output that cannot be written is named, without a stack trace", { skip: !existsSync("/dev/full") }, () => {
  const program = `"${process.execPath}" "${commandLine}" align a b`;
  const failing: [line: string, message: RegExp][] = [
    ["> /dev/full", /^error: stdout: cannot be written: ENOSPC.*\n$/],
    ["--json /dev/full", /^error: \/dev\/full: cannot be written: ENOSPC.*\n$/],
    ["--overlay /dev/null", /^error: --overlay \/dev\/null: /],
    ["2> /dev/full --json missing/x", /^$/],
  ];
  for (const [line, message] of failing) {
    const { status, stderr } = shell(`${program} ${quick.join(" ")} ${line}`);
    assert.ok(status === 1 || status === 2, line);
    assert.match(stderr, message, line);
  }
});
