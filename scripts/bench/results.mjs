/** Results of `sim3align-lab bench`, and the folder of a benchmark, from which an interrupted run is resumed. */
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { cpus, platform, release, totalmem } from "node:os";
import { join } from "node:path";
import { attempt } from "../lib/run.mjs";

/** @typedef {Record<string, number | null>} Metrics by name, as `src/metrics/mod.rs` has them */
/**
 * A result: `ResultRow` of `lab/src/bench/result.rs`, with the name of its row.
 * @typedef {object} ResultRow
 * @property {string} row
 * @property {string} name of the case, unique in its row
 * @property {string} [class]
 * @property {boolean | null} strict null where the truth is unknown
 * @property {boolean | null} loose
 * @property {readonly [scale: number, rotationDeg: number, place: number | null] | null} errors
 * @property {number | null} [confidence]
 * @property {number | null} [scaleSd] standard deviation of the scale, relative
 * @property {number | null} [ms]
 * @property {Record<string, number> | null} [work] counts: `Counts` of `geometry/src/counts.rs`
 * @property {Metrics | null} [metrics]
 * @property {Metrics | null} [truthMetrics]
 * @property {boolean} [collapsed]
 * @property {boolean} [clamped]
 * @property {Features | null} [features]
 * @property {string | null} [error]
 */
/** @typedef {{ score: number, terms: number[], alternatives: number[], uncertainty: [number, number] | null }} Features */

/**
 * The results in a file, in the order of the cases' names: threads end in any order.
 * @param {string} file
 * @returns {ResultRow[]}
 */
export function readResults(file) {
  const lines = readFileSync(file, "utf8").split("\n");
  const results = lines.filter((line) => line !== "").map((line) => JSON.parse(line));
  return results.sort((a, b) => (a.name < b.name ? -1 : a.name > b.name ? 1 : 0));
}

/**
 * Opens the folder of a run. `identity`, its inputs and the digest of the code, distinguishes it from other runs.
 * @param {string} folder
 * @param {Record<string, unknown>} identity
 * @param {boolean} fresh forget what is there
 */
export function openResults(folder, identity, fresh) {
  if (fresh) rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  const file = join(folder, "identity.json");
  const text = `${JSON.stringify(identity, null, 2)}\n`;
  if (existsSync(file) && readFileSync(file, "utf8") !== text) {
    const remedy = "Remedy: --fresh forgets them, --out DIR leaves them as they are.";
    throw new Error(`${folder} holds results of other inputs or another version of the code. ${remedy}`);
  }
  writeFileSync(file, text);
}

/** Machine and versions, for people who compare figures. */
export async function environment() {
  const said = async (/** @type {string} */ command, /** @type {string[]} */ args) =>
    (await attempt(command, args)).output.trim();
  const [commit, changes, rustc] = await Promise.all([
    said("git", ["rev-parse", "HEAD"]),
    said("git", ["status", "--porcelain", "--untracked-files=no"]),
    said("rustc", ["--version"]),
  ]);
  const processors = cpus();
  return {
    commit: changes === "" ? commit : `${commit} with changes`,
    date: new Date().toISOString(),
    machine: `${processors.length} × ${processors[0]?.model.trim() ?? "?"}, ${Math.round(totalmem() / 2 ** 30)} GiB`,
    system: `${platform()} ${release()}`,
    node: process.version,
    rustc,
  };
}
