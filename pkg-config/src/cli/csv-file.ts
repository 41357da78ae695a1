/** The results as a table of comma-separated values. */
import { isRecord } from "../values/values.js";
import { isMetric } from "./lengths.js";
import { LineFile } from "./line-file.js";
import { shownIn } from "./pictures.js";
import { checkReplaceable, checkWritable } from "./writable.js";

type Entry = Readonly<Record<string, unknown>>;

/** Follows property names and indices into a JSON value. */
const at =
  (...path: (string | number)[]) =>
  (entry: Entry): unknown =>
    path.reduce<unknown>((value, key) => (value as Record<string | number, unknown> | undefined | null)?.[key], entry);

const lengthOf = (value: unknown) => (Array.isArray(value) ? value.length : undefined);
const codes = (value: unknown) =>
  Array.isArray(value) ? value.map((each) => (isRecord(each) ? each.code : "")).join(" ") : undefined;

const group = (name: string, keys: readonly string[]) => keys.map((key) => [key, at(name, key)] as const);

/** The columns after the name, read from the JSON entry of a case. They do not depend on the results. */
const allColumns: readonly (readonly [heading: string, read: (entry: Entry) => unknown])[] = [
  ["error", at("error", "code")],
  ["confidence", at("confidence")],
  ["alternatives", (entry) => lengthOf(entry.alternatives)],
  ["isMetric", (entry) => ("error" in entry ? undefined : isMetric(entry))],
  ["scale", at("scale")],
  ...["qx", "qy", "qz", "qw"].map((heading, i) => [heading, at("quaternion", i)] as const),
  ...["txM", "tyM", "tzM"].map((heading, i) => [heading, at("translation", i)] as const),
  ...group("diagnostics", ["initialScale", "scaleRatio"]),
  ...group("metrics", ["iou", "boundaryF", "centerDriftPx", "chamferMm", "uniChamferMm", "fitness"]),
  ...group("metrics", ["normalConsistency", "depthMaeMm"]),
  ...group("errors", ["scaleError", "rotationErrorDeg", "translationErrorM", "translationErrorRelative", "addSMm"]),
  ["warnings", (entry) => codes(entry.warnings)],
  ["timeMs", at("timingsMs", "total")],
];

/** The columns; those in metres and millimetres are empty for lengths without a unit. */
const columns = allColumns.map(
  ([heading, read]) =>
    [heading, /M(m)?$/.test(heading) ? (entry: Entry) => (isMetric(entry) ? read(entry) : undefined) : read] as const,
);

/** The headings, for --help. */
export const csvHeadings: readonly string[] = ["case", ...columns.map(([heading]) => heading)];

/** A row for each case, or for each frame or object of one, after a row of headings (RFC 4180 with line feeds). Values that a case lacks are empty. */
export class CsvFile {
  readonly #lines: LineFile;
  #isEmpty = true;

  /** @throws {@link UsageError} if the file cannot be written */
  constructor(path: string) {
    if (path !== "-" && checkWritable("--csv", path)) {
      checkReplaceable("--csv", path, (beginning) => beginning.startsWith(`${csvHeadings.join(",")}\n`));
    }
    this.#lines = new LineFile(path, "w");
  }

  add(name: string, entry: object): void {
    // A case of several views has a pose of its own; a scene or a video only has those of its parts.
    const shown = "confidence" in entry ? [{ name, entry: entry as Entry }] : shownIn(name, entry);
    const rows = shown.map((each) => [each.name, ...columns.map(([, read]) => read(each.entry))].map(cell).join(","));
    this.#lines.append(this.#isEmpty ? [csvHeadings.join(","), ...rows] : rows);
    this.#isEmpty = false;
  }

  end(): void {
    this.#lines.end();
  }
}

function cell(value: unknown): string {
  const text = value === undefined || value === null ? "" : String(value);
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}
