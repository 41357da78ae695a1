/** The summary of a set: a line for each of its rows, small enough for a history of all versions. */
import { mean, median, share } from "../bench/table.mjs";
import { rounded } from "./sets.mjs";

/** Number of bins of the reliability diagram. */
export const BINS = 10;

/**
 * @typedef {object} Summary
 * @property {string} set
 * @property {string} row
 * @property {number} n
 * @property {number} strict share of cases
 * @property {number} loose
 * @property {readonly (number | null)[]} medians of the errors of scale, rotation (degrees) and place, of the answered cases
 * @property {readonly (readonly [n: number, strict: number])[]} bins of the confidence, from 0 to 1
 * @property {number | null} ms median
 * @property {number | null} work mean number of renders
 * @property {number | null} iou mean
 * @property {number | null} truthIou mean
 */

/**
 * @param {string} set
 * @param {readonly import("./sets.mjs").Line[]} lines
 * @returns {Summary[]}
 */
export const summaries = (set, lines) =>
  [...new Set(lines.map(({ row }) => row))].map((row) =>
    summary(
      set,
      row,
      lines.filter((line) => line.row === row),
    ),
  );

/**
 * @param {string} set
 * @param {string} row
 * @param {readonly import("./sets.mjs").Line[]} lines
 * @returns {Summary}
 */
function summary(set, row, lines) {
  const known = (/** @type {(line: import("./sets.mjs").Line) => number | null | undefined} */ of) =>
    lines.map(of).filter((value) => value !== null && value !== undefined);
  const orNull = (/** @type {readonly number[]} */ values, /** @type {(of: readonly number[]) => number} */ reduce) =>
    values.length === 0 ? null : rounded(reduce(values));
  const bins = Array.from({ length: BINS }, () => /** @type {[number, number]} */ ([0, 0]));
  for (const { confidence, strict } of lines) {
    const bin = confidence === null ? undefined : bins[Math.min(BINS - 1, Math.floor(confidence * BINS))];
    if (bin === undefined) continue;
    bin[0] += 1;
    bin[1] += strict ? 1 : 0;
  }
  return {
    set,
    row,
    n: lines.length,
    strict: rounded(share(lines.map((line) => line.strict))),
    loose: rounded(share(lines.map((line) => line.loose))),
    medians: [0, 1, 2].map((i) =>
      orNull(
        known(({ errors }) => errors?.[i]),
        median,
      ),
    ),
    bins: bins.some(([n]) => n > 0) ? bins : [],
    ms: orNull(
      known(({ ms }) => ms),
      median,
    ),
    work: orNull(
      known(({ work }) => work),
      mean,
    ),
    iou: orNull(
      known(({ iou }) => iou),
      mean,
    ),
    truthIou: orNull(
      known(({ truthIou }) => truthIou),
      mean,
    ),
  };
}
