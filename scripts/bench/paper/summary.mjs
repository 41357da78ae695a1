/** The columns of the paper's tables, in the paper's order and units, and their values over the cases of a row. */
import { isWithin, judged, loose, strict, typicalError } from "../records.mjs";
import { mean, median, share } from "../table.mjs";

/** @typedef {import("../records.mjs").BenchRecord} BenchRecord */
/**
 * @typedef {object} Column
 * @property {string} key its name in `Metrics` of `src/metrics/mod.rs`
 * @property {string} title
 * @property {number} digits after the point
 * @property {boolean} isShare a share of 1, of which a pose that shows nothing has none; of a distance it has no number
 */

/** @type {readonly Column[]} */
export const columns = [
  { key: "boundaryF", title: "boundary F ↑", digits: 3, isShare: true },
  { key: "centerDriftPx", title: "drift px ↓", digits: 1, isShare: false },
  { key: "iou", title: "IoU ↑", digits: 3, isShare: true },
  { key: "chamferMm", title: "Chamfer mm ↓", digits: 1, isShare: false },
  { key: "uniChamferMm", title: "UniChamfer mm ↓", digits: 1, isShare: false },
  { key: "fitness", title: "fitness ↑", digits: 3, isShare: true },
  { key: "normalConsistency", title: "normals ↑", digits: 3, isShare: true },
  { key: "depthMaeMm", title: "depth MAE mm ↓", digits: 1, isShare: false },
];

/**
 * A pose's value of a column; null where it is a distance that can't be measured.
 * @param {Record<string, number | null> | null | undefined} metrics
 * @param {Column} column
 */
export function metricValue(metrics, { key, isShare }) {
  return metrics?.[key] ?? (isShare ? 0 : null);
}

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
  const error = (/** @type {keyof import("../records.mjs").PoseErrors} */ name) => finite(typicalError(known, name));
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
    collapsed: finite(share(answers.map(({ diagnostics }) => diagnostics.collapsed))),
    clamped: finite(share(answers.map(({ diagnostics }) => diagnostics.clamped))),
  };
}

/**
 * The metrics of the true pose: no pose can be expected to do better.
 * @param {readonly BenchRecord[]} records
 * @returns {Pick<Summary, "n" | "answered" | "metrics">}
 */
export function summariseTruth(records) {
  const known = judged(records);
  return { n: known.length, answered: known.length, metrics: metricsOf(known.map((record) => record.truthMetrics)) };
}

/** @param {readonly (Record<string, number | null> | null | undefined)[]} all */
function metricsOf(all) {
  const of = (/** @type {Column} */ column) => statistic(all.flatMap((metrics) => metricValue(metrics, column) ?? []));
  return Object.fromEntries(columns.map((column) => [column.key, of(column)]));
}

/**
 * The median time of an answer, in seconds. It is kept apart from the other values, which do not depend on the machine.
 * @param {readonly BenchRecord[]} records
 */
export const typicalSeconds = (records) => finite(median(records.map(({ seconds }) => seconds)));
