/** What a row of a table says of all its cases. */
import { judged } from "../records.mjs";
import { mean, median, share } from "../statistics.mjs";
import { isWithin, loose, strict } from "../tolerance.mjs";
import { columns, metricValue } from "./columns.mjs";

/** @typedef {import("../records.mjs").BenchRecord} BenchRecord */
/** @typedef {{ mean: number | null, median: number | null, n: number }} Statistic */

/**
 * @typedef {object} Summary
 * @property {number} n cases
 * @property {number} answered cases with a pose
 * @property {Record<string, Statistic>} metrics by {@link columns}' key
 * @property {{ strict: number | null, loose: number | null }} success shares of the cases whose truth is known
 * @property {{ scale: number | null, rotationDeg: number | null, translation: number | null }} errors medians over
 * those, no answer being as wrong as can be; null where that is the median
 * @property {number | null} collapsed share of the answered whose scale is below 0.3 of the initial one
 * @property {number | null} clamped share of the answered whose scale stands at the guard
 */

/** JSON has neither NaN nor ∞. @param {number} value */
const finite = (value) => (Number.isFinite(value) ? value : null);

/** @param {readonly number[]} values @returns {Statistic} */
const statistic = (values) => ({ mean: finite(mean(values)), median: finite(median(values)), n: values.length });

/**
 * @param {readonly BenchRecord[]} records
 * @returns {Summary}
 */
export function summarise(records) {
  const known = judged(records);
  const answers = records.flatMap(({ alignment }) => alignment ?? []);
  const error = (/** @type {"scaleError" | "rotationErrorDeg" | "translationErrorRelative"} */ name) =>
    finite(median(known.map(({ errors }) => errors?.[name] ?? Number.POSITIVE_INFINITY)));
  return {
    n: records.length,
    answered: answers.length,
    metrics: metricsOf(records.map(({ alignment }) => alignment?.metrics)),
    success: {
      strict: finite(share(known.map(({ errors }) => isWithin(errors, strict)))),
      loose: finite(share(known.map(({ errors }) => isWithin(errors, loose)))),
    },
    errors: {
      scale: error("scaleError"),
      rotationDeg: error("rotationErrorDeg"),
      translation: error("translationErrorRelative"),
    },
    collapsed: finite(share(answers.map(({ collapsed }) => collapsed))),
    clamped: finite(share(answers.map(({ clamped }) => clamped))),
  };
}

/**
 * What the true pose's own metrics are: no pose can be expected to do better.
 * @param {readonly BenchRecord[]} records
 * @returns {Pick<Summary, "n" | "answered" | "metrics">}
 */
export function summariseTruth(records) {
  const known = judged(records);
  return { n: known.length, answered: known.length, metrics: metricsOf(known.map((record) => record.truthMetrics)) };
}

/** @param {readonly (Record<string, number | null> | null | undefined)[]} all */
function metricsOf(all) {
  const of = (/** @type {import("./columns.mjs").Column} */ column) =>
    statistic(all.flatMap((metrics) => metricValue(metrics, column) ?? []));
  return Object.fromEntries(columns.map((column) => [column.key, of(column)]));
}

/**
 * What an answer takes, in seconds: the median. Apart from the rest, which does not depend on the machine.
 * @param {readonly BenchRecord[]} records
 */
export const typicalSeconds = (records) => finite(median(records.map(({ seconds }) => seconds)));
