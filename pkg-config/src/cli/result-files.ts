/** The files of results: JSON, and comma-separated values. They appear when the batch ends, also early. */

import { type Entry, isMetric, posesIn, rowFields } from "./entry.js";
import type { OutputFile } from "./output-file.js";
import { isLength } from "./row.js";

/** An output for the entries of cases. */
export interface EntrySink {
  /** @param path the absolute path of the case, if it has one */
  add(name: string, entry: Entry, path?: string): void;
  /** Writes what is not written yet, and puts the file in its place. */
  end(): void;
  /** Leaves an earlier file as it is. */
  discard?(): void;
}

/** Whether a file begins like the output of --json: case names with their entries. */
export const isResults = (beginning: string) =>
  /^\{\n {2}"(?:[^"\\]|\\.)*": \{\n {4}"/.test(beginning) || /^\{\s*\}\s*$/.test(beginning);

/** An object with an entry for each case. */
export class ResultsFile implements EntrySink {
  #separator = "{\n";

  /** @param relative the path that the file has of a case */
  constructor(
    private readonly file: OutputFile,
    private readonly relative: (path: string) => string,
  ) {}

  add(name: string, entry: Entry, path?: string): void {
    const place = path === undefined ? {} : { path: this.relative(path) };
    const text = JSON.stringify({ ...place, ...entry }, null, 2).replaceAll("\n", "\n  ");
    this.file.write(`${this.#separator}  ${JSON.stringify(name)}: ${text}`);
    this.#separator = ",\n";
  }

  end(): void {
    this.file.write(this.#separator === "{\n" ? "{}\n" : "\n}\n");
    this.file.end();
  }

  discard(): void {
    this.file.discard();
  }
}

/** The headings of a table of comma-separated values. */
export const csvHeadings: readonly string[] = ["case", ...rowFields.map(([name]) => name)];

/** Whether a file begins like the output of --csv. */
export const isCsv = (beginning: string) => beginning.startsWith(`${csvHeadings.join(",")}\n`);

/**
 * A row for each case, or for each frame or object of one, after a row of headings (RFC 4180 with line feeds). What a case
 * lacks is empty, as are metres of lengths without a unit.
 */
export class CsvFile implements EntrySink {
  #head = [csvHeadings.join(",")];

  constructor(private readonly file: OutputFile) {}

  add(name: string, entry: Entry): void {
    // A case of several views has a pose of its own; a scene or a video only has those of its parts.
    const poses = "confidence" in entry ? [{ name, entry }] : posesIn(name, entry);
    const rows = poses.map((pose) =>
      [pose.name, ...rowFields.map(([fact, read]) => (isLength(fact) && !isMetric(pose.entry) ? "" : read(pose.entry)))]
        .map(csvCell)
        .join(","),
    );
    this.file.lines([...this.#head, ...rows]);
    this.#head = [];
  }

  end(): void {
    this.file.lines(this.#head);
    this.file.end();
  }

  discard(): void {
    this.file.discard();
  }
}

/** A cell. A text that spreadsheets would take for a formula is preceded by an apostrophe. */
function csvCell(value: unknown): string {
  const formula = typeof value === "string" && /^[=+\-@\t\r]/.test(value);
  const text = value === undefined || value === null ? "" : `${formula ? "'" : ""}${value}`;
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}
