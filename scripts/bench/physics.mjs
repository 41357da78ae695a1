/**
 * `npm run bench:physics`: exports scenes for simulators, and prints which bodies stay where they are during a second of
 * physics; of scenes with true poses, also how far the bodies are from these.
 */
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";
import { runLab } from "../lib/lab.mjs";
import { buildPackage } from "../lib/package.mjs";
import { at, packageDir } from "../lib/paths.mjs";
import { pythonWith, runPython } from "../lib/python.mjs";
import { attempt } from "../lib/run.mjs";
import { command, count } from "./command.mjs";
import { foldersWith, within } from "./inputs.mjs";
import { markdownTable } from "./table.mjs";

/** @typedef {{ name: string, fixed: boolean, movedM: number, turnedDeg: number, errorsMm?: [found: number, exported: number, after: number] }} Rested */
/** @typedef {{ folder: string, [simulator: string]: { bodies: Rested[] } | string }} Simulated */
/**
 * @typedef {object} Options
 * @property {number} scenes
 * @property {number} arranged
 * @property {number} setSeed
 * @property {readonly string[]} [cases]
 * @property {number} seconds
 * @property {string} quality
 * @property {number} jobs
 * @property {string} python
 * @property {boolean} [keep]
 * @property {boolean} [bodies]
 */

/** A body that has moved less, in metres and degrees, has stayed. */
const limits = { movedM: 0.005, turnedDeg: 5 };

/** @param {Options} options */
async function main({ scenes, arranged, setSeed, cases, seconds, quality, jobs, python, keep, bodies }) {
  await buildPackage();
  const root = at("target", "bench", "physics");
  if (!keep) rmSync(root, { recursive: true, force: true });
  const sets =
    cases === undefined
      ? await generated(root, { scenes, arranged, setSeed })
      : { given: foldersWith("objects", cases) };
  // Before the scenes are exported, which takes long.
  await pythonWith("simulators", python);
  for (const [name, list] of Object.entries(sets)) {
    const exported = join(root, "exported", name);
    await exportAll(list, exported, quality, jobs);
    const made = within(exported);
    /** @type {Simulated[]} */
    const results = [];
    await runPython("simulators", [`${seconds}`, ...made], python, (line) => results.push(JSON.parse(line)));
    console.log(`\n${name}: ${list.length} scenes, ${made.length} exported\n\n${tableOf(results)}`);
    if (results.some((result) => trueBodies(result).length > 0)) console.log(`\n${errorTable(results)}`);
    if (bodies) for (const result of results) printBodies(result);
  }
}

/**
 * Writes scenes as folders.
 * @param {string} root
 * @param {{ scenes: number, arranged: number, setSeed: number }} numbers
 * @returns {Promise<Record<string, string[]>>}
 */
async function generated(root, { scenes, arranged, setSeed }) {
  /** @type {Record<string, string[]>} */
  const sets = {};
  for (const [name, number] of Object.entries({ scenes, arranged })) {
    if (number === 0) continue;
    const folder = join(root, name);
    const args = ["together", `--${name}`, `${number}`, "--set-seed", `${setSeed}`, "--write", folder];
    if (!existsSync(folder)) await runLab(args);
    sets[name] = within(folder);
  }
  return sets;
}

/**
 * Aligns and exports scenes, some at a time; those that are there are kept.
 * @param {readonly string[]} list
 * @param {string} folder
 * @param {string} quality
 * @param {number} jobs
 */
async function exportAll(list, folder, quality, jobs) {
  const waiting = list.map((scene, i) => ({
    scene,
    to: join(folder, `${String(i).padStart(3, "0")}-${basename(scene)}`),
  }));
  const worker = async () => {
    for (let next = waiting.shift(); next !== undefined; next = waiting.shift()) {
      const { scene, to } = next;
      if (existsSync(join(to, "scene.usda"))) continue;
      mkdirSync(to, { recursive: true });
      const files = ["--mjcf", join(to, "mjcf"), "--urdf", join(to, "urdf"), "--usd", join(to, "scene.usda")];
      const json = join(to, "results.json");
      const args = [join(packageDir, "cli", "main.js"), "scene", scene, "--quality", quality, "--json", json, ...files];
      const { output, reason } = await attempt(process.execPath, args);
      if (reason && !existsSync(join(to, "scene.usda"))) console.log(`${scene}: ${reason}\n${output}`);
      else writeFileSync(join(to, "truth.json"), JSON.stringify(truthOf(scene, json)));
    }
  };
  await Promise.all(Array.from({ length: jobs }, worker));
}

/**
 * The poses that were found and the true ones, camera from mesh, by the name of the body.
 * @param {string} scene
 * @param {string} results the file of `--json`
 */
function truthOf(scene, results) {
  const [found] = Object.values(JSON.parse(readFileSync(results, "utf8")));
  const entries = Object.entries(found.objects).flatMap(([name, aligned]) => {
    const file = join(scene, "objects", name, "gt.json");
    if (!existsSync(file) || aligned.error !== undefined) return [];
    const truth = JSON.parse(readFileSync(file, "utf8"));
    return [[name.replace(/[^A-Za-z0-9]+/g, "_"), { aligned: sim3(aligned), truth: sim3(truth) }]];
  });
  return Object.fromEntries(entries);
}

/** @param {{ scale: number, rotation: number[] | number[][], translation: number[] }} pose */
const sim3 = ({ scale, rotation, translation }) => ({ scale, rotation: rotation.flat(), translation });

/**
 * The bodies whose errors are known.
 * @param {Simulated} result
 */
function trueBodies({ mujoco }) {
  const bodies = typeof mujoco === "object" ? mujoco.bodies : [];
  return bodies.flatMap(({ errorsMm, ...body }) => (errorsMm === undefined ? [] : [{ ...body, errorsMm }]));
}

/** @param {readonly Simulated[]} results */
function errorTable(results) {
  const rows = results.flatMap((result) =>
    trueBodies(result).map(({ name, fixed, errorsMm: [found, exported, after] }) => {
      const numbers = [found, exported, after, exported - found].map((mm) => mm.toFixed(1));
      return [basename(result.folder), name, fixed ? "fixed" : "free", ...numbers];
    }),
  );
  const headings = ["scene", "object", "", "found, mm off", "exported", "after", "exported − found"];
  return markdownTable(headings, rows);
}

/** @param {readonly Simulated[]} results */
function tableOf(results) {
  const rows = ["mujoco", "pybullet"].map((simulator) => {
    const scenes = results.map((result) => result[simulator]).filter((found) => typeof found === "object");
    const all = scenes.flatMap(({ bodies }) => bodies);
    const free = all.filter(({ fixed }) => !fixed);
    const share = (/** @type {readonly unknown[]} */ some, /** @type {readonly unknown[]} */ of) =>
      `${some.length} of ${of.length} (${((100 * some.length) / Math.max(of.length, 1)).toFixed(1)} %)`;
    const still = scenes.filter(({ bodies }) => bodies.every(stays));
    const moved = free.map(({ movedM }) => 1000 * movedM).sort((a, b) => a - b);
    const at = (/** @type {number} */ part) => (moved[Math.floor(part * (moved.length - 1))] ?? 0).toFixed(2);
    return [
      simulator,
      share(still, scenes),
      share(free.filter(stays), free),
      `${all.length - free.length}`,
      at(0.5),
      at(0.95),
    ];
  });
  return markdownTable(
    ["simulator", "scenes at rest", "free bodies at rest", "fixed", "moved, median mm", "95 % mm"],
    rows,
  );
}

const stays = (/** @type {Rested} */ { movedM, turnedDeg }) => movedM <= limits.movedM && turnedDeg <= limits.turnedDeg;

/** @param {Simulated} result */
function printBodies(result) {
  for (const simulator of ["mujoco", "pybullet"]) {
    const found = result[simulator];
    if (typeof found !== "object") continue;
    for (const { name, fixed, movedM, turnedDeg } of found.bodies.filter((body) => !stays(body))) {
      console.log(
        `${result.folder} ${simulator} ${name}${fixed ? " fixed" : ""}: ${(1000 * movedM).toFixed(1)} mm, ${turnedDeg.toFixed(1)}°`,
      );
    }
  }
}

/** @param {string} text */
const whole = (text) => Number.parseInt(text, 10);

await command("bench:physics", (program) =>
  program
    .description(
      "Which bodies of exported scenes stay within 5 mm and 5° during a second of physics, and how far they are from true poses.",
    )
    .option("--scenes <n>", "generated scenes of objects on a desk", whole, 20)
    .option("--arranged <n>", "generated scenes whose objects also lean, hang and lie on each other", whole, 8)
    .option("--set-seed <n>", "seed of the sets", whole, 501)
    .option("--cases <dir...>", "scene folders instead, or folders of them; true poses are compared")
    .option("--seconds <n>", "of physics", Number, 1)
    .option("--quality <name>", "of the alignment", "auto")
    .option("--jobs <n>", "scenes aligned at a time", count, 2)
    .option("--python <program>", "the Python that makes the environment", "python3")
    .option("--keep", "go on with what an earlier run has left")
    .option("--bodies", "name the bodies that have moved")
    .action(main),
);
