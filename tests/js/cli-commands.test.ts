/** The flags that all commands for many folders share, and what each writes by them. */
import assert from "node:assert/strict";
import { mkdirSync, readFileSync, symlinkSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { files, folder, results, run, writeCase } from "../support/command-line.js";
import { glb, npy, png } from "../support/files.js";
import { frameAt } from "../support/rig.js";
import { mesh, rotationRows, truth } from "../support/scene.js";
import { masks, standingGlb, tableView } from "../support/table.js";

const { width, height, depth, camera } = tableView;
const scene = { "depth.npy": npy(depth, height, width), "camera.json": { ...camera, width, height } };
for (const name of ["one", "two"]) {
  writeCase(`scenes/${name}`, scene);
  const [mask] = masks as [Uint8Array];
  writeCase(`scenes/${name}/objects/thing`, { "mask.png": png(mask, width, height), "mesh.glb": standingGlb });
}
const gt = { ...truth, available: true, rotation: rotationRows(truth.rotation), symmetry: "none" };
for (const name of ["one", "two"]) {
  writeCase(`cases/${name}`, { ...files, "gt.json": gt });
  writeCase(`videos/${name}`, { "mesh.glb": glb(mesh) });
  for (const [k, angle] of [0, 3].entries()) {
    const { frame, pose } = frameAt(angle);
    const known = { available: true, scale: pose.scale, rotation: rotationRows(pose.rotation), symmetry: "none" };
    writeCase(`videos/${name}/frame_0${k}`, {
      "depth.npy": npy(frame.depth, frame.height, frame.width),
      "mask.png": png(
        frame.mask.map((m) => 255 * m),
        frame.width,
        frame.height,
      ),
      "camera.json": frame.camera,
      "gt.json": { ...known, translation: pose.translation },
    });
  }
}

const commands = {
  align: { folders: "cases", flags: ["--quality", "fast"], rows: ["one", "two"] },
  scene: { folders: "scenes", flags: ["--quality", "fast"], rows: ["one/thing", "two/thing"] },
  track: { folders: "videos", flags: [], rows: ["one/frame_00", "one/frame_01", "two/frame_00", "two/frame_01"] },
  evaluate: { folders: "cases", flags: [], rows: ["one", "two"] },
};

for (const [command, { folders, flags, rows }] of Object.entries(commands)) {
  const record = (name: string) => ["--jsonl", `${command}-${name}.jsonl`, "--csv", `${command}-${name}.csv`];
  const linesOf = (path: string) => readFileSync(join(folder, path), "utf8").trimEnd().split("\n");
  const entries = (name: string) =>
    linesOf(`${command}-${name}.jsonl`)
      .map((line) => JSON.stringify(JSON.parse(line), (key, value) => (key === "timingsMs" ? undefined : value)))
      .sort();

  test(`${command} takes patterns, workers, a record and a table`, () => {
    const { status, stderr } = run(command, `${folders}/**`, ...flags, ...record("all"), "--workers", "2");
    assert.equal(status, 0, stderr);
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
    assert.equal(run(command, "--list", "list.txt", ...flags, ...record("part"), "--workers", "1").status, 0);
    const again = run(command, `${folders}/*`, ...flags, ...record("part"), "--resume", "--json", `${command}.json`);
    assert.equal(again.status, 0, again.stderr);
    assert.match(again.stderr, /resumed: 1 of 2/);
    assert.deepEqual(entries("part"), entries("all"), "as in one run, with other workers");
    assert.deepEqual(Object.keys(results(`${command}.json`)).sort(), ["one", "two"]);
    assert.equal(linesOf(`${command}-part.csv`).length, rows.length + 1);
  });

  test(`${command} names the pattern for a folder of ${folders}`, () => {
    for (const [path, pattern] of [
      [folders, `${folders}/**`],
      [join(folder, `${folders}/`), join(folder, folders, "**")],
    ] as const) {
      const { status, stderr } = run(command, path);
      assert.equal(status, 2, stderr);
      assert.ok(stderr.includes(`but holds some. Pass '${pattern}'`), stderr);
    }
    assert.equal(run(command, "list.txt").status, 2);
    assert.match(run(command).stderr, /Pass at least one \w+ folder/);
  });
}

test("scene takes the options of every object", () => {
  const { status, stderr } = run("scene", "scenes/one", "--quality", "fast", "--scale", "0.5", "--json", "fixed.json");
  assert.equal(status, 0, stderr);
  assert.ok(Math.abs(results("fixed.json").one.objects.thing.scale - 0.5) < 1e-12);
  const wrong = run("scene", "scenes/one", "--mesh-up", "0,0,0");
  assert.equal(wrong.status, 2, wrong.stderr);
});

test("evaluate compares the poses of each frame, and those of many cases", () => {
  mkdirSync(join(folder, "poses"));
  assert.equal(run("align", "videos/one", "--quality", "fast", "--json", "poses/views.json").status, 0);
  const { status, stderr, stdout } = run(
    "evaluate",
    "videos/one",
    "--transform",
    "poses/views.json",
    "--json",
    "e.json",
  );
  assert.equal(status, 0, stderr);
  assert.match(stdout, /one\/frame_01: evaluation/);
  const aligned = results("poses/views.json").one.frames;
  const { frames } = results("e.json").one;
  for (const name of ["frame_00", "frame_01"]) {
    assert.ok(frames[name].metrics.iou > 0.8 && frames[name].errors.scaleError < 0.05, name);
    assert.ok(Math.abs(frames[name].errors.scaleError - aligned[name].errors.scaleError) < 1e-9, name);
  }
  // A record has the same entries.
  const record = run("evaluate", "cases/*", "--transform", "align-all.jsonl", "--json", "r.json");
  assert.equal(record.status, 0, record.stderr);
  assert.ok(results("r.json").two.metrics.iou > 0.9);
  const missing = run("evaluate", "cases/*", "--transform", "poses/views.json");
  assert.equal(missing.status, 1, "there is a pose of one case only");
  assert.match(missing.stdout, /^two +INVALID_TRANSFORM/m);
});

test("evaluate takes a folder of links as a data set", () => {
  mkdirSync(join(folder, "links"));
  for (const name of ["x", "y"]) symlinkSync(join("..", "cases", "one"), join(folder, "links", name));
  const { status, stdout } = run("evaluate", "links/*", "--csv", "-");
  assert.equal(status, 0);
  assert.deepEqual(
    stdout
      .trimEnd()
      .split("\n")
      .slice(1)
      .map((row) => row.split(",")[0])
      .sort(),
    ["x", "y"],
  );
});
