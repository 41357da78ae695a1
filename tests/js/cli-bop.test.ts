/** `sim3align bop`: results, resume and detections. */
import assert from "node:assert/strict";
import { existsSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { readMesh } from "sim3align/formats";
import { segmentation, writeBop } from "../support/bop.js";
import { folder, read, refusesUsage, results, run, succeeds } from "../support/command-line.js";

// 640 × 480 pixels, three objects, three scenes.
const dataset = join("bop", "tudl");
writeBop(join(folder, dataset));

const bop = (words: string) => succeeds(`bop ${dataset} --split test ${words}`);
const near = (found: unknown, expected: number, tolerance: number, what: string) =>
  assert.ok(typeof found === "number" && Math.abs(found - expected) <= tolerance, `${what}: ${found}, not ${expected}`);

test("targets are aligned at their size; the results file is that of the leaderboard, also of a resumed batch", () => {
  const flags = "--quality fast --jsonl r.jsonl --json r.json";
  const { stderr } = bop(flags);
  const file = "sim3align_tudl-test.csv";
  assert.match(stderr, new RegExp(`results: ${file}`));
  const [header, ...rows] = read(file).trimEnd().split("\n");
  assert.deepEqual([header, rows.length], ["scene_id,im_id,obj_id,score,R,t,time", 9]);
  const times = new Map<string, string>();
  for (const row of rows) {
    const [scene, image, , score, R = "", t = "", time = ""] = row.split(",");
    assert.deepEqual([R.split(" ").length, t.split(" ").length], [9, 3]);
    assert.ok(Number(t.split(" ")[2]) > 500, "millimetres");
    assert.ok(Number(score) >= 0 && Number(score) <= 1 && Number(time) > 0);
    assert.equal(times.get(`${scene}/${image}`) ?? time, time, "one time per image");
    times.set(`${scene}/${image}`, time);
  }
  const entries = results("r.json");
  // Of three bricks, the two most visible ones are targets.
  const names = ["1/0/1-0", "1/0/2-1", "1/7/2-0", "1/7/2-2", "1/7/3-1", "2/3/1-1", "2/3/3-0", "3/1/1-0", "3/1/3-1"];
  assert.deepEqual(Object.keys(entries).sort(), names);
  for (const name of names) near(entries[name].scale, 0.001, 1e-12, "scale");

  // What is recorded is not aligned again, and gives the same file.
  const before = read(file);
  rmSync(join(folder, file));
  assert.match(bop("--quality fast --jsonl r.jsonl --resume").stderr, /resumed: 9 of 9/);
  assert.equal(read(file), before);
});

test("detections take the place of masks, and pictures show the poses", async () => {
  const detection = async (image: number, id: number, score: number, path: string) => ({
    ...{ scene_id: 1, image_id: image, category_id: id, score, time: 0.5 },
    segmentation: await segmentation(`000001/mask_visib/${path}`),
  });
  const detections = await Promise.all([
    detection(7, 2, 0.3, "000007_000003.png"),
    detection(7, 2, 0.9, "000007_000000.png"),
    detection(7, 2, 0.8, "000007_000002.png"),
    detection(0, 1, 0.5, "000000_000000.png"),
  ]);
  writeFileSync(join(folder, "detections.json"), JSON.stringify(detections));
  const pictures = "--report pictures --overlay overlay --glb posed";
  const { stderr } = bop(`--masks detections.json --quality fast --suffix cnos --json d.json ${pictures}`);
  assert.doesNotMatch(stderr, /no pictures/);
  const entries = results("d.json");
  const names = ["1/0/1-0", "1/7/2-0", "1/7/2-1"];
  assert.deepEqual(Object.keys(entries).sort(), names);
  assert.equal(readdirSync(join(folder, "overlay")).length, names.length);
  const [file = ""] = readdirSync(join(folder, "posed")).sort();
  // The posed mesh is in metres, in the frame of a glTF camera: y up, z backward.
  const { positions } = await readMesh(readFileSync(join(folder, "posed", file)));
  const depths = positions.filter((_, i) => i % 3 === 2);
  near((Math.min(...depths) + Math.max(...depths)) / 2, -entries["1/0/1-0"].translation[2], 0.05, "the posed mesh");
  for (const row of read("sim3align_tudl-test_cnos.csv").trimEnd().split("\n").slice(1)) {
    const [, image = 0, , score = 1, , , time = 0] = row.split(",").map(Number);
    assert.ok(score <= (image === 7 ? 0.9 : 0.5), "times the score of the detection");
    assert.ok(time >= 0.5, "plus the time of the detections");
  }
});

test("what cannot be read is reported, with the file", () => {
  for (const [name, text] of Object.entries({
    ...{ "object.json": "{}", "empty.json": "[]" },
    "entry.json": '[{ "scene_id": 1 }]',
  }))
    writeFileSync(join(folder, name), text);
  const wrong: Record<string, RegExp> = {
    "--masks object.json": /no list/,
    "--masks entry.json": /entry 0/,
    "--masks empty.json": /nothing to align/,
    "--suffix a_b": /--suffix a_b/,
    "--split nowhere": /nothing to read at .*nowhere/,
    "--models nowhere": /--models nowhere: there is no such/,
  };
  for (const [words, expected] of Object.entries(wrong)) {
    refusesUsage({ [`bop ${dataset} --split test ${words}`]: expected });
  }
  // A split without targets: everything that is a tenth visible.
  mkdirSync(join(folder, "bop", "empty", "val"), { recursive: true });
  assert.equal(run(`bop ${join("bop", "empty")} --split val`).status, 2);
  assert.ok(!existsSync(join(folder, "sim3align_empty-val.csv")));
});
