/** Other libraries' registration on our cases, and on pairs of clouds: the Python package `peers`. */
import { existsSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { availableParallelism } from "node:os";
import { basename, join, resolve } from "node:path";
import { foldersOf } from "../lib/cache.mjs";
import { buildPackage } from "../lib/package.mjs";
import { at } from "../lib/paths.mjs";
import { runPython } from "../lib/python.mjs";
import { compiledModule } from "../speed/inputs.mjs";

/**
 * @typedef {object} PeersRun
 * @property {readonly string[]} [cases] case folders, or folders of case folders
 * @property {string} [pairs] or a list of pairs of clouds, `[{ id, source, target, voxelSizeM }]`
 * @property {string} out answers go to `OUT/METHOD/NAME.json`; those that are there are kept
 * @property {readonly string[]} methods
 * @property {string} [python] the Python, 3.11 or 3.12, that makes the environment
 */

const quick = ["open3d-fgr", "open3d-gicp", "open3d-icp-point-to-plane", "open3d-icp-point-to-point"];
quick.push("open3d-ransac", "open3d-ransac-scale", "small-gicp", "kiss-matcher");

/** Methods that align a mesh in the benchmark. @param {boolean} isQuick */
export const meshMethods = (isQuick) => (isQuick ? quick : [...quick, "probreg-cpd"]);

/** Methods that align two clouds. */
export const pairMethods = ["open3d-ransac", "open3d-fgr", "kiss-matcher"];

/**
 * Runs the methods; installs them first where that has not been done.
 * @param {PeersRun} options
 * @returns {Promise<string[]>} the methods with answers: without those whose library cannot be loaded
 */
export async function runPeers({ cases = [], pairs, out, methods, python }) {
  const args = ["--out", resolve(out), "--jobs", `${availableParallelism()}`, "--threads", "1", "--seed", "0"];
  args.push("--methods", methods.join());
  if (pairs !== undefined) args.push("--pairs", resolve(pairs));
  const inputs = at("target", "bench", "inputs");
  if (pairs === undefined) {
    const isCase = (/** @type {string} */ folder) => existsSync(join(folder, "mask.png"));
    await writeInputs(foldersOf(cases, isCase), inputs);
    args.push("--cases", inputs);
  }
  await runPython("peers", args, python);
  rmSync(inputs, { recursive: true, force: true });
  return methods.filter((method) => existsSync(join(out, method)));
}

/**
 * Writes cases as the files of bare numbers that the Python package reads.
 * @param {readonly string[]} cases
 * @param {string} folder
 */
async function writeInputs(cases, folder) {
  await buildPackage();
  rmSync(folder, { recursive: true, force: true });
  const [{ readCaseFolder }, { resolveInput }, { fileReaders }] = await Promise.all(
    ["case-folder.js", "input/resolve.js", "modules/readers.js"].map(compiledModule),
  );
  for (const path of cases) {
    const { core } = await resolveInput((await readCaseFolder(path)).input, fileReaders);
    const { mask, camera, width, height } = core;
    const depth = Float32Array.from(core.depth, (/** @type {number} */ z) => z * (core.depthScale ?? 1));
    const { positions } = core.mesh;
    const mesh = { positions, indices: Uint32Array.from(core.mesh.indices ?? Array(positions.length / 3).keys()) };
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
