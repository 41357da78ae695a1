/** The columns of a record's table, in the terminal and on the page. */
import { fixed, percent } from "../bench/table.mjs";

/** @typedef {import("./summary.mjs").Summary} Summary */

/** A share in per cent with two digits. @param {number | null | undefined} value */
const share = (value) => fixed(value == null ? value : 100 * value, 2);

/** Poses whose confidence is .9 or more, and those of them that are right. @param {Summary} row */
function sure({ bins }) {
  const [n, right] = bins.at(-1) ?? [0, 0];
  return bins.length > 0 ? `${right} of ${n}` : "–";
}

/** @type {readonly (readonly [head: string, cell: (row: Summary) => string | number])[]} */
const columns = [
  ["row", ({ row }) => row],
  ["n", ({ n }) => n],
  ["strict %", ({ strict }) => percent(strict)],
  ["loose %", ({ loose }) => percent(loose)],
  ["scale %", ({ medians }) => share(medians[0])],
  ["rotation °", ({ medians }) => fixed(medians[1], 2)],
  ["place %", ({ medians }) => share(medians[2])],
  ["≥ .9: right of", sure],
  ["IoU, truth's", ({ iou, truthIou }) => (iou === null ? "–" : `${fixed(iou, 3)}, ${fixed(truthIou, 3)}`)],
  ["ms", ({ ms }) => fixed(ms)],
];

export const head = columns.map(([title]) => title);

/** @param {Summary} row */
export const cellsOf = (row) => columns.map(([, cell]) => cell(row));
