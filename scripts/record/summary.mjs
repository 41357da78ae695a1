/** The summary of a set: a line for each of its rows, small enough for a history of all versions; and its columns. */
import { fixed, mean, median, percent, share } from "../bench/table.mjs";

/** @typedef {import("../bench/results.mjs").ResultRow} ResultRow */
/**
 * @typedef {object} Summary
 * @property {string} set
 * @property {string} row
 * @property {number} n
 * @property {number} strict share of cases
 * @property {number} loose
 * @property {readonly (number | null)[]} medians of the errors of scale, rotation (degrees) and place, of the answered cases
 * @property {readonly (readonly [n: number, strict: number])[]} bins of the confidence, from 0 to 1
 * @property {number | null} covered share of the sizes of confident poses that are within their 90 % interval
 * @property {number | null} ms median
 * @property {number | null} work mean number of renders
 * @property {number | null} iou mean
 * @property {number | null} truthIou mean
 */

/** Number of bins of the confidence. */
const BINS = 10;

/** Four digits, which are more than any set can tell. @param {number} value */
export const rounded = (value) => Number(value.toPrecision(4));

/**
 * @param {string} set
 * @param {readonly ResultRow[]} results
 * @returns {Summary[]}
 */
export const summaries = (set, results) =>
  [...new Set(results.map(({ row }) => row))].map((row) => {
    const of = results.filter((result) => result.row === row);
    const reduced = (
      /** @type {(values: readonly number[]) => number} */ reduce,
      /** @type {(result: ResultRow) => number | null | undefined} */ value,
    ) => {
      const known = of.map(value).filter((x) => x !== null && x !== undefined);
      return known.length === 0 ? null : rounded(reduce(known));
    };
    return {
      ...{ set, row, n: of.length },
      strict: rounded(share(of.map(({ strict }) => strict === true))),
      loose: rounded(share(of.map(({ loose }) => loose === true))),
      medians: [0, 1, 2].map((i) => reduced(median, ({ errors }) => errors?.[i])),
      bins: binsOf(of),
      covered: reduced(mean, isCovered),
      ms: reduced(median, ({ ms }) => ms),
      work: reduced(mean, ({ work }) => work?.renders),
      iou: reduced(mean, ({ metrics }) => metrics?.iou),
      truthIou: reduced(mean, ({ truthMetrics }) => truthMetrics?.iou),
    };
  });

/** Standard deviations on either side of a mean that hold 90 % of a normal distribution. */
const WITHIN_90 = 1.645;

/** 1 for a size within its interval, 0 beyond; null without one, or without confidence. @param {ResultRow} result */
function isCovered({ confidence, errors, scaleSd }) {
  if (confidence == null || confidence < 0.9 || errors == null || scaleSd == null) return null;
  return (errors[0] ?? 0) <= WITHIN_90 * scaleSd ? 1 : 0;
}

/** Poses, and right ones, by tenths of the confidence; none without confidences. @param {readonly ResultRow[]} results */
function binsOf(results) {
  const bins = Array.from({ length: BINS }, () => /** @type {[number, number]} */ ([0, 0]));
  for (const { confidence, strict } of results) {
    const bin = confidence == null ? undefined : bins[Math.min(BINS - 1, Math.floor(confidence * BINS))];
    if (bin === undefined) continue;
    bin[0] += 1;
    bin[1] += strict ? 1 : 0;
  }
  return bins.some(([n]) => n > 0) ? bins : [];
}

/** A share in per cent with two digits. @param {number | null | undefined} value */
const two = (value) => fixed(value == null ? value : 100 * value, 2);

/** @type {readonly (readonly [head: string, cell: (row: Summary) => string | number])[]} */
const columns = [
  ["set", ({ set }) => set],
  ["row", ({ row }) => row],
  ["n", ({ n }) => n],
  ["strict %", ({ strict }) => percent(strict)],
  ["loose %", ({ loose }) => percent(loose)],
  ["scale %", ({ medians }) => two(medians[0])],
  ["rotation °", ({ medians }) => fixed(medians[1], 2)],
  ["place %", ({ medians }) => two(medians[2])],
  ["≥ .9: right of", ({ bins }) => (bins.length === 0 ? "–" : `${bins.at(-1)?.[1]} of ${bins.at(-1)?.[0]}`)],
  ["size held %", ({ covered }) => (covered == null ? "–" : percent(covered))],
  ["IoU, truth's", ({ iou, truthIou }) => (iou === null ? "–" : `${fixed(iou, 3)}, ${fixed(truthIou, 3)}`)],
  ["ms", ({ ms }) => fixed(ms)],
];

export const head = columns.map(([title]) => title);

/** @param {Summary} row */
export const cellsOf = (row) => columns.map(([, cell]) => cell(row));

/** Sets of poses that were found without a hint, and none in the frames of one video. */
const pooled = ["general", "sensors", "colors", "surplus", "scenes", "arranged", "views", "monocular"];

/**
 * How far a confidence can be trusted: poses by confidence, in all rows of some sets but the one without the photo, which alone
 * tells some turns apart.
 * @param {readonly Summary[]} rows
 * @returns {(string | number)[][]} cells: confidence, poses, right ones in per cent
 */
export function reliability(rows) {
  const counted = rows.filter(({ set, row }) => pooled.includes(set) && row !== "shape alone");
  const sum = (/** @type {number} */ bin, /** @type {0 | 1} */ which) =>
    counted.reduce((all, { bins }) => all + (bins[bin]?.[which] ?? 0), 0);
  return Array.from({ length: BINS }, (_, bin) => [
    `${(bin / BINS).toFixed(1)} to ${((bin + 1) / BINS).toFixed(1)}`,
    sum(bin, 0),
    percent(sum(bin, 1) / sum(bin, 0)),
  ]);
}
