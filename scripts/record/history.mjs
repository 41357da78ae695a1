/** The history in the repository: of each version its run, a line for each row of a set, and the cases it doubts most. */
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { at } from "../lib/paths.mjs";

const file = at("docs", "record", "history.jsonl");

/** Doubted cases that are kept of a version. */
const DOUBTS = 40;

/**
 * @typedef {object} Run
 * @property {string} version
 * @property {string} commit
 * @property {string} date
 * @property {string} machine
 * @property {string} system
 * @property {string} node
 * @property {string} rustc
 */

/**
 * @typedef {object} Doubt
 * @property {string} set
 * @property {string} case
 * @property {number} confidence
 * @property {boolean} strict
 * @property {string} doubt
 */

/**
 * @typedef {object} Version
 * @property {Run & { sizes: Readonly<Record<string, number>> }} run
 * @property {import("./summary.mjs").Summary[]} rows
 * @property {Doubt[]} doubts
 */

/**
 * Writes the lines of a version, in place of those that it may have.
 * @param {Run} run
 * @param {Readonly<Record<string, number>>} sizes bytes of the modules, gzipped
 * @param {readonly import("./summary.mjs").Summary[]} rows
 * @param {readonly { set: string, lines: readonly import("./sets.mjs").Line[] }[]} sets
 */
export function extendHistory(run, sizes, rows, sets) {
  const { version } = run;
  const doubted = sets.flatMap(({ set, lines }) =>
    lines.flatMap(({ case: name, confidence, strict, doubt }) =>
      doubt === undefined || confidence === null ? [] : [{ set, case: name, confidence, strict, doubt }],
    ),
  );
  // Those of a folder of the user stay with the user.
  const own = doubted.filter(({ set }) => set !== "given").sort((a, b) => a.confidence - b.confidence);
  const lines = [
    { kind: "run", ...run, sizes },
    ...rows.filter(({ set }) => set !== "given").map((row) => ({ kind: "row", version, ...row })),
    ...own.slice(0, DOUBTS).map((doubt) => ({ kind: "doubt", version, ...doubt })),
  ];
  const others = linesOfAll().filter((line) => line.version !== version);
  writeFileSync(file, [...others, ...lines].map((line) => `${JSON.stringify(line)}\n`).join(""));
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
  return all
    .filter(({ kind }) => kind === "run")
    .map((run) => ({
      run,
      rows: all.filter(({ kind, version }) => kind === "row" && version === run.version),
      doubts: all.filter(({ kind, version }) => kind === "doubt" && version === run.version),
    }));
}
