/** Lengths in what is printed: metric, or in a unit that nobody knows. */
import { isRecord } from "../values/values.js";
import { fixed } from "./table.js";

/** What is said once of results whose lengths have no unit. */
export const noUnitNote =
  "Lengths have no unit, because nothing metric is known: --known-extent, or a number as --scale, makes them metric.";

/** Whether the lengths of a result, or of its JSON entry, are metres. */
export function isMetric(result: object): boolean {
  const { depthCalibration, frames, views = frames, ...own } = result as Readonly<Record<string, unknown>>;
  if (isRecord(depthCalibration)) return depthCalibration.isMetric !== false;
  if (typeof views === "object" && views !== null) return Object.values(views).every(isMetric);
  return own.isMetric !== false;
}

/** How lengths are printed. */
export class Lengths {
  constructor(readonly isMetric: boolean) {}

  /** The unit of numbers without a prefix. */
  get unit(): string {
    return this.isMetric ? "m" : "units";
  }

  /** A length with its unit; one of millimetres has three more decimals without them. */
  millimetres(mm: number | null | undefined, digits: number): string {
    if (mm === null || mm === undefined) return fixed(mm, digits);
    return this.isMetric ? `${fixed(mm, digits)} mm` : `${fixed(mm / 1000, digits + 3)} ${this.unit}`;
  }

  /** A cell of a column of millimetres, which only metric lengths have. */
  cell(mm: number | null | undefined, digits: number): string {
    return fixed(this.isMetric ? mm : null, digits);
  }
}
