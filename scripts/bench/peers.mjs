/** Other libraries' registration on our cases, and on pairs of clouds: the Python package `peers`. */
import { spawn } from "node:child_process";
import { availableParallelism } from "node:os";
import { resolve } from "node:path";
import { createInterface } from "node:readline";
import { at } from "../lib/paths.mjs";
import { pythonEnvironment, pythonVariables } from "./python.mjs";

/** @typedef {{ method: string, case: string, seconds: number | null, error?: string }} Progress */

/**
 * @typedef {object} PeersRun
 * @property {readonly string[]} [cases] case folders, or folders of case folders
 * @property {string} [pairs] or a list of pairs of clouds, `[{ id, source, target, voxelSizeM }]`
 * @property {string} out answers go to `OUT/METHOD/NAME.json`; those that are there are kept
 * @property {readonly string[]} [methods] all that apply by default
 * @property {number} [jobs] processes, each on one core; as many as there are cores by default
 * @property {string} [python] the Python, 3.11 or 3.12, that makes the environment
 * @property {(progress: Progress) => void} [onProgress] called once per answer
 */

/** The environment's Python, installed where it has not been. @param {string} [program] */
export const installPeers = (program = "python3") =>
  pythonEnvironment("peers", at("scripts", "bench", "peers", "requirements.txt"), program);

/**
 * Runs the methods; installs them first where that has not been done.
 * @param {PeersRun} options
 */
export async function runPeers({ cases, pairs, out, methods, jobs = availableParallelism(), python, onProgress }) {
  /** @type {string[]} */
  const input =
    pairs === undefined ? ["--cases", ...(cases ?? []).map((path) => resolve(path))] : ["--pairs", resolve(pairs)];
  const some = methods === undefined ? [] : ["--methods", methods.join()];
  await peers([...input, "--out", resolve(out), "--jobs", `${jobs}`, ...some], python, (line) =>
    onProgress?.(JSON.parse(line)),
  );
}

/**
 * Fails where a method does not recover motions that are known.
 * @param {string} [python]
 */
export const testPeers = (python) => peers(["--self-test"], python, console.log);

/**
 * @param {readonly string[]} args
 * @param {string} [program]
 * @param {(line: string) => void} [onLine]
 */
async function peers(args, program, onLine = () => {}) {
  const python = await installPeers(program);
  const child = spawn(python, ["-m", "peers", ...args], {
    stdio: ["ignore", "pipe", "inherit"],
    env: { ...process.env, ...pythonVariables },
  });
  /** @type {Promise<number | null>} */
  const ended = new Promise((done, fail) => child.on("error", fail).on("close", done));
  for await (const line of createInterface({ input: child.stdout })) onLine(line);
  const status = await ended;
  if (status !== 0) throw new Error(`python -m peers ${args.join(" ")}: exit status ${status}; see above.`);
}
