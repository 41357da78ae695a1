/** Inputs of sets that the lab reads from folders: pairs of clouds, and what other libraries answer. */
import { existsSync } from "node:fs";
import { join } from "node:path";
import { meshMethods, runPeers, versionsOf } from "../bench/peers.mjs";
import { runLab } from "../lib/lab.mjs";
import { at } from "../lib/paths.mjs";
import { attempt, CommandError } from "../lib/run.mjs";

/** Libraries that other people would take; the others of `bench:peers` are variants of these. */
const methods = Object.keys(meshMethods(false));

/**
 * Writes cases and the answers of other libraries to them. Returns the arguments of the lab that read both, or why there are
 * none.
 * @param {string} folder
 * @param {readonly string[]} generated arguments of the lab that generate the cases
 */
export async function peerInputs(folder, generated) {
  const [cases, answers] = [join(folder, "cases"), answersIn(folder)];
  await runLab([...generated, "--write", cases]);
  try {
    await runPeers({ cases: [cases], out: answers, methods });
  } catch (error) {
    if (error instanceof CommandError) return `no Python with the libraries (${error.message})`;
    throw error;
  }
  const imports = methods.flatMap((method) => ["--import", `${method}=${join(answers, method)}`]);
  return ["--cases", cases, ...imports];
}

const answersIn = (/** @type {string} */ folder) => join(folder, "answers");

/** The versions of the libraries whose answers a folder has. @param {string} folder */
export const peerVersions = (folder) => (existsSync(answersIn(folder)) ? versionsOf(answersIn(folder)) : {});

/**
 * Writes rooms in the layout of 3DMatch.
 * @param {string} folder
 * @param {readonly string[]} options
 */
export async function roomInputs(folder, options) {
  await runLab(["registration", "write", "rooms", folder, ...options]);
  return ["--data", folder];
}

/**
 * Measures the WebAssembly memory of a large alignment, in bytes, beside its limits.
 * @param {string} json where it is kept
 */
export async function measureMemory(json) {
  const { reason } = await attempt(process.execPath, [
    at("scripts", "bench", "memory.mjs"),
    "--alignments",
    "100",
    "--json",
    json,
  ]);
  return reason;
}
