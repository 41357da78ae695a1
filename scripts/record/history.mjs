/** The history in the repository: of each version its run, and a line for each row of a set. */
import { existsSync, readFileSync, writeFileSync } from "node:fs";
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
  const lines = [...linesOfAll().filter((line) => line.version !== version), { kind: "run", ...run }, ...own];
  writeFileSync(file, lines.map((line) => `${JSON.stringify(line)}\n`).join(""));
}

/** @returns {any[]} */
const linesOfAll = () =>
  existsSync(file)
    ? readFileSync(file, "utf8")
        .split("\n")
        .filter((line) => line !== "")
        .map((line) => JSON.parse(line))
    : [];

/** All versions, the oldest first. @returns {Version[]} */
export function history() {
  const all = linesOfAll();
  const runs = all.filter(({ kind }) => kind === "run");
  return runs.map((run) => ({ run, rows: all.filter((line) => line.kind === "row" && line.version === run.version) }));
}
