/** Records of `sim3align-lab bench`: what came of each case. */
import { existsSync, mkdirSync, readFileSync } from "node:fs";
import { dirname, resolve } from "node:path";
import { runLab } from "../lib/lab.mjs";
import { median } from "./table.mjs";

/** @typedef {{ scaleError: number, rotationErrorDeg: number, translationErrorRelative: number }} PoseErrors */

/** Scale within 5 %, rotation within 10° up to symmetry, translation within 5 % of the diameter. */
export const strict = { scale: 0.05, rotationDeg: 10, translation: 0.05 };
/** Twice as far. */
export const loose = { scale: 0.1, rotationDeg: 20, translation: 0.1 };

/**
 * Whether a pose is near enough; no answer is not.
 * @param {PoseErrors | null | undefined} errors
 * @param {typeof strict} tolerance
 */
export const isWithin = (errors, tolerance) =>
  !!errors &&
  errors.scaleError <= tolerance.scale &&
  errors.rotationErrorDeg <= tolerance.rotationDeg &&
  errors.translationErrorRelative <= tolerance.translation;

/**
 * The outcome of a case: the fields of `Record` in `lab/src/bench/benchmark.rs` that the tables use.
 * @typedef {object} BenchRecord
 * @property {string} name
 * @property {string} tier
 * @property {string} class
 * @property {Record<string, number>} parameters
 * @property {BenchAlignment | null} alignment
 * @property {PoseErrors | null} errors
 * @property {number | null} rightAlternative index of the first alternative within the strict tolerance
 * @property {number | null} nearAlternative and within the loose one
 * @property {Metrics | null} truthMetrics
 * @property {number | null} truthScore
 * @property {number} seconds
 */

/** @typedef {Record<string, number | null>} Metrics by name, as `src/metrics/mod.rs` has them */

/**
 * `Alignment` or `PaperAlignment` of `src/report/`, as far as tables need it. What only `precise` reports is missing
 * from the others.
 * @typedef {object} BenchAlignment
 * @property {number[]} matrix camera from mesh, column by column
 * @property {number} scale
 * @property {number[]} rotation quaternion xyzw
 * @property {number} [confidence]
 * @property {readonly { score: number }[]} [alternatives]
 * @property {{ scale: number, rotationDeg: number } | null} [uncertainty]
 * @property {Metrics} metrics
 * @property {BenchDiagnostics} diagnostics
 */

/**
 * @typedef {object} BenchDiagnostics
 * @property {boolean} collapsed
 * @property {boolean} clamped
 * @property {number} [score]
 * @property {{ overlap: number, depth: number, outline: number }} [terms]
 */

/** @typedef {{ row: string, records: BenchRecord[] }} BenchRow */

/**
 * @typedef {object} BenchOptions
 * @property {number} [cases] of the generated set
 * @property {number} [misfits] cases of it with the mesh of another
 * @property {string} [set] name of the generated set
 * @property {number} [setSeed]
 * @property {readonly string[]} [folders] case folders, or folders of them, whose colours are left out
 * @property {string} [meshes]
 * @property {number} [threads]
 * @property {string} json
 * @property {string} [from]
 */

/**
 * The rows that an earlier run kept, or those of a run now.
 * @param {BenchOptions} options
 * @param {readonly string[]} rows of `--row`
 * @returns {Promise<BenchRow[]>}
 */
export async function benchmarkRows({ cases, misfits, set, setSeed, folders, meshes, threads, json, from }, rows) {
  if (from === undefined) {
    mkdirSync(dirname(resolve(json)), { recursive: true });
    const args = ["--json", resolve(json)];
    if (cases !== undefined) args.push("--generated", `${cases}`);
    if (setSeed !== undefined) args.push("--set-seed", `${setSeed}`);
    if (folders !== undefined) args.push("--no-color", "--cases", ...folders.map((folder) => resolve(folder)));
    if (misfits !== undefined) args.push("--misfits", `${misfits}`);
    if (set !== undefined) args.push("--set", set);
    if (meshes !== undefined) args.push("--meshes", resolve(meshes));
    if (threads !== undefined) args.push("--threads", `${threads}`);
    await runLab(["bench", ...args, ...rows.flatMap((row) => ["--row", row])], { echo: "errors" });
  }
  return JSON.parse(readFileSync(from ?? json, "utf8")).rows;
}

/**
 * The median of an error; no answer is as wrong as can be.
 * @param {readonly { errors: PoseErrors | null | undefined }[]} all
 * @param {keyof PoseErrors} name
 */
export const typicalError = (all, name) => median(all.map(({ errors }) => errors?.[name] ?? Number.POSITIVE_INFINITY));

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
  const { score } = alignment.diagnostics;
  if (score === undefined || truthScore === null) return "unknown";
  return score < truthScore ? "search" : "scoring";
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

/**
 * The records of a file, by row, each row's in the order of the cases' names: the order in which threads were done
 * says nothing.
 * @param {string} file
 * @returns {Map<string, BenchRecord[]>}
 */
export function readRecords(file) {
  /** @type {Map<string, BenchRecord[]>} */
  const rows = new Map();
  if (!existsSync(file)) return rows;
  for (const line of readFileSync(file, "utf8").split("\n")) {
    if (line === "") continue;
    const { row, case: name, record } = JSON.parse(line);
    const records = rows.get(row) ?? [];
    records.push({ ...record, name });
    rows.set(row, records);
  }
  for (const records of rows.values()) records.sort((a, b) => (a.name < b.name ? -1 : 1));
  return rows;
}
