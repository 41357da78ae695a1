/** Statistics of measurements, and Markdown tables of them. */

/** @typedef {readonly (string | number)[]} Row */

/**
 * A table whose columns are as wide as their widest cell; the first is flush left, the others right.
 * @param {readonly string[]} head
 * @param {readonly Row[]} rows
 */
export function markdownTable(head, rows) {
  const lines = [head, ...rows].map((row) => row.map(String));
  const widths = head.map((_, i) => Math.max(3, ...lines.map((line) => (line[i] ?? "").length)));
  const format = (/** @type {readonly string[]} */ line) =>
    `| ${widths.map((width, i) => (i ? (line[i] ?? "").padStart(width) : (line[i] ?? "").padEnd(width))).join(" | ")} |`;
  const rule = `|${widths.map((width, i) => (i ? `${"-".repeat(width + 1)}:` : "-".repeat(width + 2))).join("|")}|`;
  const [first = [], ...others] = lines;
  return [format(first), rule, ...others.map(format)].join("\n");
}

/**
 * A number with so many digits after the point; a dash for what there is none of.
 * @param {number | null | undefined} value
 * @param {number} [digits]
 */
export function fixed(value, digits = 0) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  return Number.isFinite(value) ? value.toFixed(digits) : "∞";
}

/**
 * A share in per cent.
 * @param {number} value
 */
export const percent = (value) => fixed(100 * value, 1);

/**
 * The middle value, or the mean of the two middle ones; NaN of nothing.
 * @param {Iterable<number>} values
 */
export function median(values) {
  const sorted = [...values].sort((a, b) => a - b);
  const middle = sorted.length >> 1;
  const [low, high] = [sorted[middle - 1] ?? Number.NaN, sorted[middle] ?? Number.NaN];
  if (sorted.length % 2 === 1) return high;
  return low === high ? high : (low + high) / 2;
}

/**
 * The value below which this share of the values lies; NaN of nothing.
 * @param {readonly number[]} values
 * @param {number} share
 */
export function quantile(values, share) {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? Number.NaN;
}

/**
 * The mean; NaN of nothing.
 * @param {readonly number[]} values
 */
export const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;

/**
 * The share of `true`; NaN of nothing.
 * @param {readonly boolean[]} values
 */
export const share = (values) => values.filter(Boolean).length / values.length;
