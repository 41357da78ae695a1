/** What a record says of results: a line of figures, and how often each confidence is right. */
import { fixed, mean, median, percent, share } from "../bench/table.mjs";

/** @typedef {import("../bench/results.mjs").ResultRow} ResultRow */

/** Standard deviations on either side of a mean that hold 90 % of a normal distribution. */
const WITHIN_90 = 1.645;

/** @param {readonly ResultRow[]} results @returns {readonly ResultRow[]} */
const confident = (results) => results.filter(({ confidence }) => confidence != null && confidence >= 0.9);

/** The median of an error of the answered cases, with two digits. @param {readonly ResultRow[]} results @param {0 | 1 | 2} i */
const error = (results, i, unit = 1) => fixed(unit * median(results.flatMap(({ errors }) => errors?.[i] ?? [])), 2);

/** @type {readonly (readonly [head: string, cell: (results: readonly ResultRow[]) => string | number])[]} */
const columns = [
  ["cases", (results) => results.length],
  ["strict %", (results) => percent(share(results.map(({ strict }) => strict === true)))],
  ["loose %", (results) => percent(share(results.map(({ loose }) => loose === true)))],
  ["scale error %", (results) => error(results, 0, 100)],
  ["rotation error °", (results) => error(results, 1)],
  ["translation error %", (results) => error(results, 2, 100)],
  ["believed: right of", (results) => rightOf(confident(results))],
  ["size in interval %", (results) => percent(mean(confident(results).flatMap(isSizeHeld)))],
  ["ms", (results) => fixed(median(results.flatMap(({ ms }) => ms ?? [])))],
];

export const heads = columns.map(([head]) => head);

/** @param {readonly ResultRow[]} results */
export const cellsOf = (results) => columns.map(([, cell]) => cell(results));

/** @param {readonly ResultRow[]} results */
export const rightOf = (results) => `${results.filter(({ strict }) => strict).length} of ${results.length}`;

/** Whether a size is within the interval that the result states: nothing where there is none. @param {ResultRow} result */
const isSizeHeld = ({ errors, scaleSd }) =>
  errors == null || scaleSd == null ? [] : [Number(errors[0] <= WITHIN_90 * scaleSd)];

/** Poses by tenths of their confidence, and the share of right ones. @param {readonly ResultRow[]} results */
export const reliability = (results) =>
  Array.from({ length: 10 }, (_, tenth) => {
    const of = results.filter(
      ({ confidence }) => confidence != null && Math.min(Math.floor(10 * confidence), 9) === tenth,
    );
    const right = of.map(({ strict }) => strict === true);
    return [`${(tenth / 10).toFixed(1)} to ${((tenth + 1) / 10).toFixed(1)}`, of.length, percent(share(right))];
  });

export const reliabilityHeads = ["confidence", "poses", "right %"];
