/** The columns of the table. */
import { decimals } from "./dom.js";
import type { ReportRow } from "./types.js";

/** A column: its heading, the text of a cell, and what it is sorted by. */
export interface Column {
  id: string;
  heading: string;
  /** What the heading means, as a tooltip. */
  title?: string;
  text(row: ReportRow): string;
  /** Missing values come last in either order; a failure has no number. */
  key(row: ReportRow): number | string | null;
}

const number = (
  id: string,
  heading: string,
  title: string,
  read: (row: ReportRow) => number | null | undefined,
  digits: number,
): Column => ({ id, heading, title, text: (row) => decimals(read(row), digits), key: (row) => read(row) ?? null });

const common: readonly Column[] = [
  number("confidence", "Confidence", "Probability that the pose is right", (row) => row.confidence, 2),
  { id: "name", heading: "Case", text: (row) => row.name, key: (row) => row.name },
  number(
    "alternatives",
    "Alternatives",
    "Other poses that explain the image nearly as well",
    (row) => (row.error === undefined ? row.alternatives : null),
    0,
  ),
  number("scale", "Scale", "Metres, or units of the result's own, per unit of the mesh", (row) => row.scale, 4),
  number("iou", "IoU", "Overlap of silhouette and mask", (row) => row.iou, 3),
  number("boundaryF", "Boundary F", "Agreement of the outlines", (row) => row.boundaryF, 3),
  number(
    "depthMaeMm",
    "Depth, mm",
    "Mean absolute difference of depth, if it is metric",
    (row) => (row.isMetric ? row.depthMaeMm : null),
    2,
  ),
];

const errors: readonly Column[] = [
  number("scaleError", "Δ scale, %", "Against the true pose", (row) => row.errors && 100 * row.errors.scale, 1),
  number("rotationError", "Δ rotation, °", "Against the true pose", (row) => row.errors?.rotationDeg, 1),
  number(
    "translationError",
    "Δ place, %",
    "Against the true pose, of the diameter",
    (row) => row.errors && 100 * row.errors.translation,
    1,
  ),
];

const last: readonly Column[] = [
  {
    id: "warnings",
    heading: "Warnings",
    text: (row) => row.error?.code ?? row.warnings.map(({ code }) => code).join(", "),
    key: (row) => row.error?.code ?? (row.warnings.map(({ code }) => code).join() || null),
  },
  number("timeMs", "Time, s", "Time of the alignment", (row) => (row.timeMs === null ? null : row.timeMs / 1000), 2),
];

/** The columns that the rows fill. */
export const columnsOf = (rows: readonly ReportRow[]): readonly Column[] => [
  ...common,
  ...(rows.some((row) => row.errors !== undefined) ? errors : []),
  ...last,
];
