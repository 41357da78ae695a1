/** The table of an ablation. */
import { failureCounts, judged, tiersOf } from "./records.mjs";
import { mean, median, share } from "./statistics.mjs";
import { fixed, markdownTable, percent } from "./table.mjs";
import { isWithin, loose, strict } from "./tolerance.mjs";

/** @typedef {import("./records.mjs").BenchRow} BenchRow */
/** @typedef {import("./records.mjs").BenchRecord} BenchRecord */

/**
 * Success of all cases and by tier, and what is typical of the errors, per set of options.
 * @param {readonly BenchRow[]} rows
 */
export function ablationTable(rows) {
  const tiers = tiersOf(judged(rows[0]?.records ?? []));
  const head = [
    "strict / loose %",
    "all",
    ...tiers,
    "scale %",
    "rotation °",
    "transl. %",
    "IoU",
    "s",
    "search f.",
    "scoring f.",
  ];
  return markdownTable(
    head,
    rows.map(({ row, records }) => [row, ...cells(judged(records), tiers)]),
  );
}

/** @param {readonly BenchRecord[]} records @param {readonly string[]} tiers */
function cells(records, tiers) {
  const groups = [records, ...tiers.map((tier) => records.filter((record) => record.tier === tier))];
  const error = (/** @type {"scaleError" | "rotationErrorDeg" | "translationErrorRelative"} */ name) =>
    // No answer is as wrong as can be.
    median(records.map(({ errors }) => errors?.[name] ?? Number.POSITIVE_INFINITY));
  const overlaps = records.flatMap(({ alignment }) => alignment?.metrics.iou ?? []);
  const { search, scoring } = failureCounts(records);
  return [
    ...groups.map((group) => [strict, loose].map((tolerance) => successPercent(group, tolerance)).join(" / ")),
    ...[fixed(100 * error("scaleError"), 2), fixed(error("rotationErrorDeg"), 2)],
    ...[fixed(100 * error("translationErrorRelative"), 2), fixed(mean(overlaps), 3)],
    ...[fixed(median(records.map(({ seconds }) => seconds)), 2), search, scoring],
  ];
}

/** @param {readonly BenchRecord[]} records @param {typeof strict} tolerance */
const successPercent = (records, tolerance) => percent(share(records.map(({ errors }) => isWithin(errors, tolerance))));
