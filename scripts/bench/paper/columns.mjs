/** The columns of the paper's tables, in the paper's order and units. */

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
