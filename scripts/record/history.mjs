/** The history in the repository: of each version its run, and a line for each row of a set. */
import { writeFileSync } from "node:fs";
import { jsonLines } from "../bench/results.mjs";
import { at } from "../lib/paths.mjs";

const file = at("docs", "record", "history.jsonl");

/**
 * @typedef {object} Run
 * @property {string} version
 * @property {string} commit
 * @property {string} date
 * @property {string} machine
 * @property {string} rustc
 * @property {Readonly<Record<string, number>>} sizes bytes of the modules, gzipped
 */
/** @typedef {{ run: Run, rows: import("./summary.mjs").Summary[] }} Version */

/**
 * Writes the lines of a version, in place of those that it may have. Those of a folder of the user stay with the user.
 * @param {Run} run
 * @param {readonly import("./summary.mjs").Summary[]} rows
 */
export function extendHistory(run, rows) {
  const { version } = run;
  const own = rows.filter(({ set }) => set !== "given").map((row) => ({ kind: "row", version, ...row }));
  const lines = [...jsonLines(file).filter((line) => line.version !== version), { kind: "run", ...run }, ...own];
  writeFileSync(file, lines.map((line) => `${JSON.stringify(line)}\n`).join(""));
}

/** All versions, the oldest first. @returns {Version[]} */
export function history() {
  const all = jsonLines(file);
  const runs = all.filter(({ kind }) => kind === "run");
  return runs.map((run) => ({ run, rows: all.filter((line) => line.kind === "row" && line.version === run.version) }));
}
