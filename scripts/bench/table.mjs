/** Markdown tables. */

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
