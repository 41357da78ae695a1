/** The row of a pose in tables, on a terminal and in a report: its values, and the format of each column. */

/** A column: its headings on a terminal and in a report. A column without the second is not in reports. */
export interface Column {
  short: string;
  heading?: string;
  /** The tooltip of the heading. */
  title?: string;
  digits: number;
  /** From the value in the row to the number in the cell. */
  factor?: number;
  /** Whether `digits` are significant ones. */
  isSignificant?: boolean;
}

const truth = "Against the true pose";

/** The columns by the names of their values. */
export const columns = {
  confidence: { short: "conf.", heading: "Confidence", title: "Probability that the pose is right", digits: 2 },
  alternatives: {
    ...{ short: "alt.", heading: "Alternatives", digits: 0 },
    title: "Other poses that explain the image nearly as well",
  },
  scale: {
    ...{ short: "scale", heading: "Scale", digits: 4, isSignificant: true },
    title: "Metres, or units of the result's own, per unit of the mesh",
  },
  scaleRatio: { short: "s/s_init", digits: 3 },
  iou: { short: "IoU", heading: "IoU", title: "Overlap of silhouette and mask", digits: 3 },
  boundaryF: { short: "bound. F", heading: "Boundary F", title: "Agreement of the outlines", digits: 3 },
  centerDriftPx: { short: "drift px", digits: 1 },
  chamferM: { short: "Chamfer mm", digits: 2, factor: 1000 },
  fitness: { short: "fitness", digits: 3 },
  depthMaeM: {
    ...{ short: "MAE mm", heading: "Depth, mm", digits: 2, factor: 1000 },
    title: "Mean absolute difference of depth, if it is metric",
  },
  scaleError: { short: "Δscale %", heading: "Δ scale, %", title: truth, digits: 1, factor: 100 },
  rotationErrorDeg: { short: "Δrot °", heading: "Δ rotation, °", title: truth, digits: 1 },
  translationErrorM: { short: "Δtrans mm", digits: 1, factor: 1000 },
  translationErrorRelative: {
    ...{ short: "Δtrans %", heading: "Δ place, %", digits: 1, factor: 100 },
    title: `${truth}, of the diameter`,
  },
  timeMs: { short: "time s", heading: "Time, s", title: "Time of the alignment", digits: 2, factor: 0.001 },
} as const satisfies Record<string, Column>;

export type ColumnName = keyof typeof columns;

/** A code, and a text for people. */
export interface Message {
  code: string;
  message: string;
}

/** The row of a pose or of a failure. */
export interface Row extends Readonly<Partial<Record<ColumnName, number | null>>> {
  error?: Message;
  warnings: readonly Message[];
  /** Whether lengths are metric; otherwise, their unit is unknown. */
  isMetric: boolean;
}

/** Whether the name is that of a length, in metres. */
export const isLength = (name: string) => name.endsWith("M");

/** The value in a column; `null` for lengths without a unit, and for missing values. */
export function numberIn(row: Row, name: ColumnName): number | null {
  if (isLength(name) && !row.isMetric) return null;
  // Only a search that finds a confidence looks for alternatives.
  if (name === "alternatives" && (row.confidence ?? null) === null) return null;
  return row[name] ?? null;
}

/** The text in a column. */
export function cellOf(row: Row, name: ColumnName): string {
  const { digits, factor = 1, isSignificant = false }: Column = columns[name];
  const value = numberIn(row, name);
  return (isSignificant ? significant : fixed)(value === null ? null : factor * value, digits);
}

/** Formats a number with a fixed number of decimals; a missing one is a dash. */
export const fixed = (value: number | null | undefined, digits: number): string => value?.toFixed(digits) ?? "–";

/** Formats a number with the given significant digits, without an exponent if a few zeros suffice. */
export function significant(value: number | null | undefined, digits: number): string {
  if (value === null || value === undefined) return "–";
  if (value === 0 || !Number.isFinite(value)) return String(value);
  const magnitude = Math.floor(Math.log10(Math.abs(value)));
  return magnitude < -5 || magnitude > 8
    ? value.toExponential(digits - 1)
    : value.toFixed(Math.max(0, digits - 1 - magnitude));
}
