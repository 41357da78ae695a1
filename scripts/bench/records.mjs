/** What `sim3align-bench` measures: runs it, and reads its JSON. */
import { mkdirSync, readFileSync } from "node:fs";
import { dirname, resolve } from "node:path";
import { run } from "../lib/run.mjs";
import { isWithin, strict } from "./tolerance.mjs";

/** @typedef {import("./tolerance.mjs").PoseErrors} PoseErrors */

/**
 * What came of a case: `Record` of `src/samples/benchmark.rs`, as far as tables need it.
 * @typedef {object} BenchRecord
 * @property {string} name
 * @property {string} tier
 * @property {Record<string, number>} parameters
 * @property {BenchAlignment | null} alignment
 * @property {PoseErrors | null} errors
 * @property {Metrics | null} truthMetrics
 * @property {number | null} truthScore
 * @property {number} seconds
 */

/** @typedef {Record<string, number | null>} Metrics by name, as `src/metrics/mod.rs` has them */

/**
 * `Alignment` of `src/align/report.rs`, as far as tables need it.
 * @typedef {object} BenchAlignment
 * @property {number[]} matrix camera from mesh, column by column
 * @property {number | null} score
 * @property {number | null} confidence
 * @property {boolean} collapsed
 * @property {boolean} clamped
 * @property {Metrics} metrics
 */

/** @typedef {{ row: string, records: BenchRecord[] }} BenchRow */

/** @typedef {{ cases: number, setSeed: number, meshes?: string, threads?: number, json: string, from?: string }} BenchOptions */

/**
 * Runs the program, built as what WebAssembly is compared with.
 * @param {readonly string[]} args
 * @param {import("../lib/run.mjs").RunOptions} options
 */
export async function runBenchmark(args, options) {
  const binary = ["run", "--quiet", "--profile", "native", "--package", "sim3align-lab", "--", "bench"];
  await run("cargo", [...binary, ...args], options);
}

/**
 * The rows that an earlier run kept, or those of a run now.
 * @param {BenchOptions} options
 * @param {readonly string[]} rows of `--row`
 * @returns {Promise<BenchRow[]>}
 */
export async function benchmarkRows({ cases, setSeed, meshes, threads, json, from }, rows) {
  if (from === undefined) {
    mkdirSync(dirname(resolve(json)), { recursive: true });
    const args = ["--generated", `${cases}`, "--set-seed", `${setSeed}`, "--json", resolve(json)];
    if (meshes !== undefined) args.push("--meshes", resolve(meshes));
    if (threads !== undefined) args.push("--threads", `${threads}`);
    await runBenchmark([...args, ...rows.flatMap((row) => ["--row", row])], { echo: "errors" });
  }
  return JSON.parse(readFileSync(from ?? json, "utf8")).rows;
}

/**
 * The cases whose truth is known; only these can be right or wrong.
 * @param {readonly BenchRecord[]} records
 */
export const judged = (records) => records.filter(({ truthMetrics }) => truthMetrics !== null);

/**
 * Why a pose is wrong: the truth scores better, and the search has not found it (`search`), or it scores no better
 * (`scoring`); `unanswered` where there is no pose, null where it is right.
 * @param {BenchRecord} record
 */
export function failure({ alignment, errors, truthScore }) {
  if (isWithin(errors, strict)) return null;
  if (alignment === null) return "unanswered";
  if (alignment.score === null || truthScore === null) return "unknown";
  return alignment.score < truthScore ? "search" : "scoring";
}

/**
 * Tiers in the order in which they first come up.
 * @param {readonly BenchRecord[]} records
 */
export const tiersOf = (records) => [...new Set(records.map(({ tier }) => tier))];

/**
 * How many failures there are of each kind, in words.
 * @param {readonly BenchRecord[]} records
 */
export function failureCounts(records) {
  const kinds = records.map(failure);
  const counts = { search: 0, scoring: 0, unanswered: 0, unknown: 0 };
  for (const kind of kinds) if (kind !== null) counts[kind]++;
  return counts;
}
