/** Other libraries' registration on our cases, and on pairs of clouds: the Python package `peers`. */
import { mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { availableParallelism } from "node:os";
import { basename, join, resolve } from "node:path";
import { buildPackage } from "../lib/package.mjs";
import { at } from "../lib/paths.mjs";
import { runPython } from "../lib/python.mjs";
import { caseFolders, readTypedCase } from "../speed/inputs.mjs";

/** @typedef {{ method: string, case: string, seconds: number | null, error?: string }} Answered */

/**
 * @typedef {object} PeersRun
 * @property {readonly string[]} [cases] case folders, or folders of case folders
 * @property {string} [pairs] or a list of pairs of clouds, `[{ id, source, target, voxelSizeM }]`
 * @property {string} out answers go to `OUT/METHOD/NAME.json`; those that are there are kept
 * @property {readonly string[]} [methods] all that apply by default
 * @property {number} [jobs] processes; as many as there are cores by default
 * @property {number} [threads] of each process, 1 by default
 * @property {number} [seed]
 * @property {string} [python] the Python, 3.11 or 3.12, that makes the environment
 * @property {(answered: Answered) => void} [onAnswer]
 */

/** Seconds that one answer is expected to take. @type {Record<string, number>} */
const quick = {
  "open3d-fgr": 0.15,
  "open3d-gicp": 0.2,
  "open3d-icp-point-to-plane": 0.3,
  "open3d-icp-point-to-point": 0.3,
  "open3d-ransac": 0.5,
  "open3d-ransac-scale": 0.5,
  "small-gicp": 0.15,
  "kiss-matcher": 0.1,
};

/**
 * Methods that align a mesh in the benchmark.
 * @param {boolean} isQuick
 */
export const meshMethods = (isQuick) => (isQuick ? quick : { ...quick, "probreg-cpd": 4 });

/** Methods that align two clouds. @type {Record<string, number>} */
export const pairMethods = { "open3d-ransac": 2, "open3d-fgr": 1, "kiss-matcher": 0.5 };

/**
 * Runs the methods; installs them first where that has not been done.
 * @param {PeersRun} options
 */
export async function runPeers({ cases, pairs, out, methods, python, onAnswer, ...more }) {
  const { jobs = availableParallelism(), threads = 1, seed = 0 } = more;
  const args = ["--out", resolve(out), "--jobs", `${jobs}`, "--threads", `${threads}`, "--seed", `${seed}`];
  if (methods !== undefined) args.push("--methods", methods.join());
  if (pairs !== undefined) args.push("--pairs", resolve(pairs));
  const inputs = at("target", "bench", "inputs");
  if (pairs === undefined) {
    await writeInputs(caseFolders(cases ?? []), inputs);
    args.push("--cases", inputs);
  }
  await runPython("peers", args, python, (line) => onAnswer?.(JSON.parse(line)));
  rmSync(inputs, { recursive: true, force: true });
}

/**
 * Fails where a method does not recover motions that are known.
 * @param {string} [python]
 */
export const testPeers = (python) => runPython("peers", ["--self-test"], python, console.log);

/**
 * Writes cases as the files of bare numbers that the Python package reads.
 * @param {readonly string[]} cases
 * @param {string} folder
 */
async function writeInputs(cases, folder) {
  await buildPackage();
  rmSync(folder, { recursive: true, force: true });
  for (const path of cases) {
    const { input } = await readTypedCase(path);
    const { depth, mask, camera, width, height, mesh } = input;
    const made = join(folder, basename(path));
    mkdirSync(made, { recursive: true });
    writeFileSync(join(made, "case.json"), JSON.stringify({ camera, width, height }));
    for (const [name, numbers] of Object.entries({ depth, mask, ...mesh })) writeFileSync(join(made, name), numbers);
  }
}

/**
 * The libraries' names and versions, as their answers have them.
 * @param {string} answers a folder of methods' folders
 * @returns {Record<string, string>}
 */
export function versionsOf(answers) {
  /** @type {Record<string, string>} */
  const versions = {};
  for (const method of readdirSync(answers)) {
    const [first] = readdirSync(join(answers, method));
    if (first === undefined) continue;
    const { software = "" } = JSON.parse(readFileSync(join(answers, method, first), "utf8"));
    const [name = "", version = ""] = software.split(" ");
    if (version !== "") versions[name] = version;
  }
  return versions;
}
