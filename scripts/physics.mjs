/** `npm run physics`: exports scenes for simulators and measures which bodies stay there, as they were found; see `--help`. */
import { existsSync, mkdirSync, rmSync } from "node:fs";
import { basename, join } from "node:path";
import { command } from "./bench/command.mjs";
import { fixed, markdownTable, median } from "./bench/table.mjs";
import { foldersOf } from "./lib/cache.mjs";
import { buildPackage } from "./lib/package.mjs";
import { at, packageDir } from "./lib/paths.mjs";
import { runPython } from "./lib/python.mjs";
import { run } from "./lib/run.mjs";

/** How far a body is from where it was found. @typedef {[rotationDeg: number, farthestPointMm: number]} Farther */
/** @typedef {{ name: string, fixed: boolean, movedM: number, turnedDeg: number }} Body */
/** @typedef {{ folder: string, mujoco: { bodies: (Body & { exported: Farther, after: Farther })[] }, pybullet: { bodies: Body[] } }} Simulated */

/** A body that has moved less has stayed. @param {Body} body */
const stays = ({ movedM, turnedDeg }) => movedM <= 0.005 && turnedDeg <= 5;

/** @param {string} folder */
const isScene = (folder) => existsSync(join(folder, "objects"));

/**
 * Aligns and exports a scene with the command line of the package.
 * @param {string} scene
 * @param {string} to
 */
async function exportScene(scene, to) {
  mkdirSync(to, { recursive: true });
  const files = ["--mjcf", join(to, "mjcf"), "--urdf", join(to, "urdf"), "--usd", join(to, "scene.usda")];
  await run(process.execPath, [join(packageDir, "cli", "main.js"), "scene", scene, ...files]);
  return to;
}

/** @param {string[]} folders @param {{ seconds: string, python: string }} options */
async function measure(folders, { seconds, python }) {
  await buildPackage();
  const scenes = foldersOf(folders.length > 0 ? folders : [at("www", "samples", "table")], isScene);
  const root = at("target", "bench", "physics");
  rmSync(root, { recursive: true, force: true });
  const exported = [];
  for (const [i, scene] of scenes.entries()) {
    exported.push(await exportScene(scene, join(root, `${String(i).padStart(3, "0")}-${basename(scene)}`)));
  }
  const printed = (await runPython("simulators", [seconds, ...exported], python)).trimEnd();
  /** @type {Simulated[]} */
  const results = printed.split("\n").map((line) => JSON.parse(line));
  const rows = /** @type {const} */ (["mujoco", "pybullet"]).map((simulator) => {
    const free = results.flatMap((result) => result[simulator].bodies.filter((body) => !body.fixed));
    const still = results.filter((result) => result[simulator].bodies.every(stays));
    const moved = fixed(median(free.map(({ movedM }) => 1000 * movedM)), 2);
    return [simulator, `${still.length} of ${results.length}`, `${free.filter(stays).length} of ${free.length}`, moved];
  });
  console.log(
    `\n${markdownTable([`${seconds} s of physics`, "scenes at rest", "free bodies at rest", "moved, median mm"], rows)}`,
  );
  const bodies = results.flatMap(({ folder, mujoco }) =>
    mujoco.bodies.map(({ name, fixed: isFixed, exported, after }) => {
      const cells = [...exported, ...after].map((number, i) => fixed(number, i % 2 === 0 ? 2 : 1));
      return [`${basename(folder)}/${name}`, isFixed ? "fixed" : "free", ...cells];
    }),
  );
  const measures = ["exported, °", "farthest point, mm", `after ${seconds} s, °`, "farthest point, mm"];
  console.log(`\n${markdownTable(["from where it was found", "body", ...measures], bodies)}`);
}

await command("physics", (program) =>
  program
    .description(
      "Exports scenes for simulators, and measures which bodies stay within 5 mm and 5° under physics, and how far each is then from where it was found.",
    )
    .argument("[folder...]", "scene folders, or folders of them; by default a sample")
    .option("--seconds <n>", "of physics", "2")
    .option("--python <program>", "the Python that makes the environment of the simulators", "python3")
    .action(measure),
);
