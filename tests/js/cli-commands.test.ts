/** The flags that all commands for many folders share, and what each writes by them. */
import assert from "node:assert/strict";
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { files, folder, read, refusesUsage, results, run, succeeds, writeCase } from "../support/command-line.js";
import { glb } from "../support/files.js";
import { frameAt, frameFiles } from "../support/rig.js";
import { mesh, poseJson, truth } from "../support/scene.js";
import { tableFiles } from "../support/table.js";

for (const name of ["one", "two"]) {
  writeCase(`scenes/${name}`, tableFiles(1));
  writeCase(`cases/${name}`, { ...files, "gt.json": poseJson(truth) });
  writeCase(`videos/${name}`, { "mesh.glb": glb(mesh) });
  for (const [k, angle] of [0, 3].entries()) writeCase(`videos/${name}/frame_0${k}`, frameFiles(frameAt(angle)));
}

const commands = {
  align: { folders: "cases", flags: ["--quality", "fast"], rows: ["one", "two"] },
  scene: { folders: "scenes", flags: ["--quality", "fast"], rows: ["one/thing-0", "two/thing-0"] },
  track: { folders: "videos", flags: [], rows: ["one/frame_00", "one/frame_01", "two/frame_00", "two/frame_01"] },
  evaluate: { folders: "cases", flags: [], rows: ["one", "two"] },
};

for (const [command, { folders, flags, rows }] of Object.entries(commands)) {
  const record = (name: string) => ["--jsonl", `${command}-${name}.jsonl`, "--csv", `${command}-${name}.csv`];
  const linesOf = (path: string) => read(path).trimEnd().split("\n");
  const entries = (name: string) =>
    linesOf(`${command}-${name}.jsonl`)
      .map((line) => JSON.stringify(JSON.parse(line), (key, value) => (key === "timingsMs" ? undefined : value)))
      .sort();

  test(`${command} takes patterns, workers, a record and a table`, () => {
    succeeds(command, `${folders}/**`, ...flags, ...record("all"), "--workers", "2");
    assert.deepEqual(
      linesOf(`${command}-all.jsonl`)
        .map((line) => JSON.parse(line).path)
        .sort(),
      [`${folders}/one`, `${folders}/two`],
    );
    const [head = "", ...cells] = linesOf(`${command}-all.csv`);
    assert.match(head, /^case,error,confidence/);
    assert.deepEqual(cells.map((row) => row.split(",")[0]).sort(), rows);
  });

  test(`${command} takes a list, and resumes`, () => {
    writeFileSync(join(folder, "list.txt"), `${folders}/one\n`);
    succeeds(command, "--list", "list.txt", ...flags, ...record("part"), "--workers", "1");
    const resumed = ["--resume", "--json", `${command}.json`];
    const again = succeeds(command, `${folders}/*`, ...flags, ...record("part"), ...resumed);
    assert.match(again.stderr, /resumed: 1 of 2/);
    assert.deepEqual(entries("part"), entries("all"), "as in one run, with other workers");
    assert.deepEqual(Object.keys(results(`${command}.json`)).sort(), ["one", "two"]);
    assert.equal(linesOf(`${command}-part.csv`).length, rows.length + 1);
  });

  test(`${command} names the pattern for a folder of ${folders}`, () => {
    refusesUsage({
      [`${command} ${folders}`]: new RegExp(`but holds some. Pass '${folders}/\\*\\*'`),
      [`${command} ${join(folder, folders)}/`]: new RegExp(`but holds some. Pass '${join(folder, folders)}/\\*\\*'`),
      [`${command} list.txt`]: /./,
      [command]: /Pass at least one \w+ folder/,
    });
  });
}

test("scene takes the options of every object", () => {
  succeeds("scene scenes/one --quality fast --scale 0.5 --json fixed.json");
  assert.ok(Math.abs(results("fixed.json").one.objects["thing-0"].scale - 0.5) < 1e-12);
  refusesUsage({ "scene scenes/one --mesh-up 0,0,0": /./ });
});

test("evaluate compares the poses of each frame, and those of many cases", () => {
  mkdirSync(join(folder, "poses"));
  succeeds("align videos/one --quality fast --json poses/views.json");
  const { stdout } = succeeds("evaluate videos/one --transform poses/views.json --json e.json");
  assert.match(stdout, /one\/frame_01: evaluation/);
  const aligned = results("poses/views.json").one.frames;
  const { frames } = results("e.json").one;
  for (const name of ["frame_00", "frame_01"]) {
    assert.ok(frames[name].metrics.iou > 0.8 && frames[name].errors.scaleError < 0.05, name);
    assert.ok(Math.abs(frames[name].errors.scaleError - aligned[name].errors.scaleError) < 1e-9, name);
  }
  // A record has the same entries.
  succeeds("evaluate cases/* --transform align-all.jsonl --json r.json");
  assert.ok(results("r.json").two.metrics.iou > 0.9);
  const missing = run("evaluate cases/* --transform poses/views.json");
  assert.equal(missing.status, 1, "there is a pose of one case only");
  assert.match(missing.stdout, /^two +INVALID_TRANSFORM/m);
});
