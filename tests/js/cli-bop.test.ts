/** `sim3align bop`: results, resume, detections, and scores next to those of the official toolkit. */
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { existsSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { before, test } from "node:test";
import { readMesh } from "sim3align/formats";
import { height, images, resultsText, width, writeBop } from "../support/bop-dataset.js";
import { folder, read, results, run, succeeds } from "../support/command-line.js";
import { repository } from "../support/environment.js";
import { cocoRle } from "../support/files.js";
import { rotationRows } from "../support/scene.js";

/** Errors of one pose, in the names of the toolkit's fixture. */
interface Errors {
  vsd: number[];
  mssdMm: number;
  mspdPx: number;
  addMm: number;
  addSMm: number;
}

type OfficialErrors = Errors & { sceneId: number; imageId: number; objectId: number; score: number; place: number };
type Evaluated = Pick<OfficialErrors, "sceneId" | "imageId" | "objectId" | "score"> & {
  errors: Record<string, Errors>;
};

// A dataset that the toolkit knows: 640 × 480 pixels, three objects, three scenes.
const dataset = join("bop", "tudl");
const given = "test_tudl-test.csv";
let masks = new Map<string, Uint8Array>();

before(() => {
  masks = writeBop(join(folder, dataset));
  writeFileSync(join(folder, given), resultsText());
});

const bop = (...args: string[]) => succeeds("bop", dataset, "--split", "test", ...args);
const scoresIn = (file: string) => JSON.parse(read(file));
const near = (found: number | null, expected: number, tolerance: number, what: string) =>
  assert.ok(found !== null && Math.abs(found - expected) <= tolerance, `${what}: ${found} instead of ${expected}`);

/** Compares the errors of the poses with those of the toolkit. */
function compare(poses: readonly Evaluated[], official: readonly OfficialErrors[]) {
  let compared = 0;
  for (const { sceneId, imageId, objectId, score, errors } of poses) {
    for (const [place, own] of Object.entries(errors)) {
      const what = `${sceneId}/${imageId}/${objectId}, score ${score}, pose ${place}`;
      const isSame = (e: OfficialErrors) =>
        [e.sceneId, e.imageId, e.objectId, e.score, e.place].join() ===
        [sceneId, imageId, objectId, score, place].join();
      const expected = official.find(isSame);
      assert.ok(expected, what);
      for (const name of ["mssdMm", "mspdPx", "addMm", "addSMm"] as const) near(own[name], expected[name], 1e-3, what);
      for (const [i, value] of expected.vsd.entries()) near(own.vsd[i] ?? null, value, 1e-3, `${what}, VSD ${i}`);
      compared += 1;
    }
  }
  assert.equal(compared, 13);
}

test("the scores of a file are those of the official toolkit", () => {
  const { stdout } = bop("--evaluate", given, "--scores", "scores.json");
  const found = scoresIn("scores.json");
  const fixture = JSON.parse(readFileSync(join(repository, "tests", "fixtures", "bop.json"), "utf8"));
  compare(found.poses, fixture.errors);
  const { scores } = fixture;
  near(found.averageRecall, scores.bop19_average_recall, 1e-3, "AR");
  for (const name of ["vsd", "mssd", "mspd"]) near(found[name], scores[`bop19_average_recall_${name}`], 1e-3, name);
  near(found.secondsPerImage, scores.bop19_average_time_per_image, 1e-9, "time");
  assert.equal(found.targets, 9);
  assert.match(stdout, new RegExp(`AR +${found.averageRecall.toFixed(4)}\n`));
  // The scores of the objects add up to those of all.
  const objects = Object.values<{ targets: number; mssd: number }>(found.objects);
  const mssd = objects.reduce((sum, object) => sum + object.targets * object.mssd, 0) / found.targets;
  near(found.mssd, mssd, 1e-9, "MSSD of the objects");
});

test("the errors are those of the toolkit, where it is", (t) => {
  const toolkit = process.env.SIM3ALIGN_BOP_TOOLKIT;
  if (toolkit === undefined) return t.skip("SIM3ALIGN_BOP_TOOLKIT names no folder of the toolkit");
  const python = process.env.SIM3ALIGN_BOP_PYTHON ?? "python3";
  const env = { ...process.env, PYTHONPATH: toolkit, EGL_PLATFORM: "surfaceless" };
  const script = join(repository, "tests", "fixtures", "make_bop.py");
  const { status, stdout, stderr } = spawnSync(python, [script, dataset, given, "--errors-only"], {
    ...{ cwd: folder, env, encoding: "utf8" },
  });
  if (/ModuleNotFoundError/.test(stderr)) return t.skip(`${python} lacks what the toolkit needs`);
  assert.equal(status, 0, stderr);
  compare(scoresIn("scores.json").poses, JSON.parse(stdout).errors);
});

test("the true poses find every target, and no pose finds none", () => {
  const lines = images.flatMap(({ scene, image, objects }) =>
    objects.map(({ id, pose }) => {
      const millimetres = pose.translation.map((x) => 1000 * x).join(" ");
      return [scene, image, id, 1, rotationRows(pose.rotation).flat().join(" "), millimetres, -1].join(",");
    }),
  );
  writeFileSync(join(folder, "gt_tudl-test.csv"), `${lines.join("\n")}\n`);
  bop("--evaluate", "gt_tudl-test.csv", "--scores", "gt.json");
  const perfect = scoresIn("gt.json");
  assert.deepEqual([perfect.averageRecall, perfect.add, perfect.addS, perfect.secondsPerImage], [1, 1, 1, null]);
  writeFileSync(join(folder, "none_tudl-test.csv"), "scene_id,im_id,obj_id,score,R,t,time\n");
  bop("--evaluate", "none_tudl-test.csv", "--scores", "none.json");
  const { averageRecall, targets, estimates } = scoresIn("none.json");
  assert.deepEqual([averageRecall, targets, estimates], [0, 9, 0]);
});

test("targets are aligned at their size, and the results file is that of the leaderboard", () => {
  const flags = ["--quality", "fast", "--jsonl", "r.jsonl", "--json", "r.json", "--evaluate", "--scores", "own.json"];
  const { stdout, stderr } = bop(...flags);
  const file = "sim3align_tudl-test.csv";
  assert.match(stderr, new RegExp(`results: ${file}`));
  const [header, ...rows] = read(file).trimEnd().split("\n");
  assert.equal(header, "scene_id,im_id,obj_id,score,R,t,time");
  assert.equal(rows.length, 9);
  const cells = rows.map((row) => row.split(","));
  const times = new Map<string, Set<string>>();
  for (const [scene = "", image = "", , score, R = "", t = "", time = ""] of cells) {
    assert.equal(R.split(" ").length, 9);
    assert.equal(t.split(" ").length, 3);
    assert.ok(Number(t.split(" ")[2]) > 500, "millimetres");
    assert.ok(Number(score) >= 0 && Number(score) <= 1 && Number(time) > 0);
    times.set(`${scene}/${image}`, (times.get(`${scene}/${image}`) ?? new Set()).add(time));
  }
  assert.ok(
    [...times.values()].every((of) => of.size === 1),
    "one time per image",
  );
  const entries = results("r.json");
  // Of three bricks, the two most visible ones are targets.
  assert.deepEqual(Object.keys(entries).sort(), [
    "1/0/1-0",
    "1/0/2-1",
    "1/7/2-0",
    "1/7/2-2",
    "1/7/3-1",
    "2/3/1-1",
    "2/3/3-0",
    "3/1/1-0",
    "3/1/3-1",
  ]);
  for (const { scale } of Object.values<{ scale: number }>(entries)) near(scale, 0.001, 1e-12, "scale");
  const own = scoresIn("own.json");
  assert.ok(own.averageRecall > 0.8, `AR ${own.averageRecall}`);
  assert.match(stdout, /AR MSSD/);

  // What is recorded is not aligned again, and gives the same file.
  const before = read(file);
  rmSync(join(folder, file));
  const lines = read("r.jsonl").trimEnd().split("\n");
  const again = bop("--quality", "fast", "--jsonl", "r.jsonl", "--resume");
  assert.match(again.stderr, /resumed: 9 of 9/);
  assert.equal(read(file), before);
  // An interrupted batch: some poses are missing.
  writeFileSync(join(folder, "part.jsonl"), `${lines.slice(0, 7).join("\n")}\n`);
  bop("--quality", "fast", "--jsonl", "part.jsonl", "--resume", "--csv", "part", "--workers", "2");
  const withoutTimes = (text: string) => text.replace(/,[^,\n]*$/gm, "");
  assert.equal(withoutTimes(read("sim3align_tudl-test_part.csv")), withoutTimes(before));
});

test("detections take the place of masks, and pictures show the poses", async () => {
  const at = (path: string) => masks.get(join("test", path)) as Uint8Array;
  const detection = (image: number, id: number, score: number, path: string) => ({
    ...{ scene_id: 1, image_id: image, category_id: id, score, time: 0.5 },
    segmentation: cocoRle(at(join("000001", "mask_visib", path)), width, height),
  });
  writeFileSync(
    join(folder, "detections.json"),
    JSON.stringify([
      detection(7, 2, 0.3, "000007_000003.png"),
      detection(7, 2, 0.9, "000007_000000.png"),
      detection(7, 2, 0.8, "000007_000002.png"),
      detection(0, 1, 0.5, "000000_000000.png"),
    ]),
  );
  const pictures = ["--report", "pictures", "--overlay", "overlay", "--glb", "posed"];
  const flags = ["--quality", "fast", "--csv", "cnos", "--json", "d.json", ...pictures];
  const found = bop("--masks", "detections.json", ...flags);
  const entries = results("d.json");
  const names = ["1/0/1-0", "1/7/2-0", "1/7/2-1"];
  assert.deepEqual(Object.keys(entries).sort(), names);
  // The pictures that the flags ask for: of every pose.
  assert.doesNotMatch(found.stderr, /no pictures/);
  for (const [made, extension] of [
    ["overlay", ".png"],
    ["posed", ".glb"],
  ] as const) {
    const files = readdirSync(join(folder, made)).sort();
    assert.equal(files.length, names.length);
    for (const [i, file] of files.entries()) {
      assert.ok(file.startsWith(names[i]?.replaceAll("/", "-") ?? "?") && file.endsWith(extension), file);
    }
  }
  const [file = ""] = readdirSync(join(folder, "posed")).sort();
  // The posed mesh is in metres, in the frame of a glTF camera: y up, z backward.
  const { positions } = await readMesh(readFileSync(join(folder, "posed", file)));
  const depths = positions.filter((_, i) => i % 3 === 2);
  const { translation } = entries["1/0/1-0"];
  near((Math.min(...depths) + Math.max(...depths)) / 2, -translation[2], 0.05, "the depth of the posed mesh");
  const table = read(join("pictures", "rows.js"));
  for (const name of names) assert.match(table, new RegExp(`"name":"${name}","folder"`));
  const rows = read("sim3align_tudl-test_cnos.csv").trimEnd().split("\n").slice(1);
  const own = rows.map((row) => row.split(",").map(Number));
  for (const [, image = 0, , score = 1, , , time = 0] of own) {
    assert.ok(score <= (image === 7 ? 0.9 : 0.5), "times the score of the detection");
    assert.ok(time >= 0.5, "plus the time of the detections");
  }
});

test("what cannot be read says so", () => {
  const wrong = (expected: RegExp, status: number, ...args: string[]) => {
    const found = run("bop", dataset, "--split", "test", ...args);
    assert.match(found.stderr, expected);
    assert.equal(found.status, status, found.stderr);
  };
  const write = (name: string, text: string) => writeFileSync(join(folder, name), text);
  wrong(/--evaluate nowhere.csv: the file cannot be read/, 2, "--evaluate", "nowhere.csv");
  write("short.csv", "1,0,1,0.5,1 0 0 0 1 0 0 0,0 0 700,-1\n");
  wrong(/line 1/, 1, "--evaluate", "short.csv");
  wrong(/--masks nowhere.json/, 2, "--masks", "nowhere.json");
  write("object.json", "{}");
  wrong(/no list/, 1, "--masks", "object.json");
  write("entry.json", '[{ "scene_id": 1 }]');
  wrong(/entry 0/, 1, "--masks", "entry.json");
  write("empty.json", "[]");
  wrong(/nothing to align/, 2, "--masks", "empty.json");
  wrong(/targets/, 1, "--targets", "object.json", "--evaluate", given);
  wrong(/--csv a_b/, 2, "--csv", "a_b");
  wrong(/--scores needs --evaluate/, 2, "--scores", "s.json");
  wrong(/nothing to read at .*nowhere/, 1, "--split", "nowhere");
  // A split without targets: everything that is a tenth visible.
  mkdirSync(join(folder, "bop", "empty", "val"), { recursive: true });
  assert.equal(run("bop", join("bop", "empty"), "--split", "val").status, 1);
  assert.ok(!existsSync(join(folder, "sim3align_empty-val.csv")));
});
