/** The outputs of a batch: JSON, a record, comma-separated values, and text for people. */
import { isLength } from "../report-page/row.js";
import { type Entry, isMetric, posesIn, rowFields } from "./entry.js";
import { checkReplaceable, isOrdinary, OutputFile } from "./files.js";
import type { Flags } from "./flags.js";
import { type CaseKey, JsonlFile, type Resumed } from "./record.js";
import { Style } from "./table.js";

/** An output for the entries of cases. */
export interface EntrySink {
  /** @param isFinal whether no other entry will replace it */
  add(name: string, entry: Entry, isFinal: boolean): void;
  /** Writes what is not written yet. */
  end(): void;
}

const END = "\n}\n";

/** Whether a file begins as {@link ResultsFile} writes it: the names of cases, and what became of each. */
const isResults = (beginning: string) =>
  /^\{\n {2}"(?:[^"\\]|\\.)*": \{\n {4}"/.test(beginning) || beginning.trim() === "{}" || beginning === `{\n${END}`;

/** An object with an entry for each case, which is complete after each of them: an interruption loses no result. */
class ResultsFile implements EntrySink {
  readonly #file: OutputFile;
  /** Whether entries are written as they come. Pipes and devices get all of them at the end. */
  readonly #isIncremental: boolean;
  #entries: string[] = [];
  /** Bytes of the file before its end. */
  #length = 0;

  constructor(path: string) {
    checkReplaceable("--json", path, isResults);
    this.#isIncremental = isOrdinary(path);
    this.#file = new OutputFile(path, "w");
  }

  add(name: string, entry: Entry, isFinal: boolean): void {
    if (!this.#isIncremental && !isFinal) return;
    const text = `  ${JSON.stringify(name)}: ${JSON.stringify(entry, null, 2).replaceAll("\n", "\n  ")}`;
    if (!this.#isIncremental) {
      this.#entries.push(text);
      return;
    }
    const added = `${this.#length === 0 ? "{\n" : ",\n"}${text}${END}`;
    this.#file.write(added, this.#length);
    if (isFinal) this.#length += Buffer.byteLength(added) - END.length;
  }

  end(): void {
    if (!this.#isIncremental) this.#file.write(`{\n${this.#entries.join(",\n")}${END}`);
    this.#entries = [];
    this.#file.end();
  }
}

/** The headings of a table of comma-separated values. */
export const csvHeadings: readonly string[] = ["case", ...rowFields.map(([name]) => name)];

/**
 * A row for each case, or for each frame or object of one, after a row of headings (RFC 4180 with line feeds). What a case
 * lacks is empty, as are metres and millimetres of lengths without a unit.
 */
class CsvFile implements EntrySink {
  readonly #file: OutputFile;
  #isEmpty = true;

  constructor(path: string) {
    checkReplaceable("--csv", path, (beginning) => beginning.startsWith(`${csvHeadings.join(",")}\n`));
    this.#file = new OutputFile(path, "w");
  }

  add(name: string, entry: Entry, isFinal: boolean): void {
    if (!isFinal) return;
    // A case of several views has a pose of its own; a scene or a video only has those of its parts.
    const poses = "confidence" in entry ? [{ name, entry }] : posesIn(name, entry);
    const rows = poses.map((pose) =>
      [pose.name, ...rowFields.map(([fact, read]) => (isLength(fact) && !isMetric(pose.entry) ? "" : read(pose.entry)))]
        .map(csvCell)
        .join(","),
    );
    this.#file.lines(this.#isEmpty ? [csvHeadings.join(","), ...rows] : rows);
    this.#isEmpty = false;
  }

  end(): void {
    this.#file.end();
  }
}

function csvCell(value: unknown): string {
  const text = value === undefined || value === null ? "" : String(value);
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/** Writes the entries of cases to files, and tables to stdout; to stderr, if stdout gets entries. */
export class Output {
  readonly #record: JsonlFile | undefined;
  readonly #sinks: readonly EntrySink[];
  readonly #tables: NodeJS.WriteStream;
  /** Text style of the tables. */
  readonly style: Style;
  #isClosed = false;

  /** @throws {@link UsageError} if a file has other content than that of an earlier run */
  constructor(
    { json, jsonl, csv, resume = false }: Pick<Flags, "json" | "jsonl" | "csv" | "resume">,
    sinks: EntrySink[],
  ) {
    this.#sinks = [
      ...(json === undefined ? [] : [new ResultsFile(json)]),
      ...(csv === undefined ? [] : [new CsvFile(csv)]),
      ...sinks,
    ];
    this.#record = jsonl === undefined ? undefined : new JsonlFile(jsonl, resume);
    this.#tables = [json, jsonl, csv].includes("-") ? process.stderr : process.stdout;
    this.style = new Style(this.#tables);
    this.#tables.on("error", () => {
      this.#isClosed = true;
    });
  }

  /** Whether nothing will be read any more: "| head" has ended, and there is no file. */
  get isClosed(): boolean {
    return this.#isClosed && this.#record === undefined && this.#sinks.length === 0;
  }

  /** The entries of the record, before it is written, each with its case. */
  resumed<T extends CaseKey>(tasks: readonly T[]): AsyncIterable<Resumed<T>> | readonly Resumed<T>[] {
    return this.#record?.resumed(tasks) ?? [];
  }

  /** Adds the entry of a case to all files. */
  add(key: CaseKey, entry: Entry): void {
    // First the record from which the others can be written again.
    this.#record?.add(key, entry);
    this.addToOthers(key.name, entry);
  }

  /** Adds an entry to all files but the record. One that is not final will be replaced. */
  addToOthers(name: string, entry: Entry, isFinal = true): void {
    for (const sink of this.#sinks) sink.add(name, entry, isFinal);
  }

  /** Writes what is not written yet, and closes the files. */
  end(): void {
    this.#record?.end();
    for (const sink of this.#sinks) sink.end();
  }

  /** Writes human-readable lines. */
  lines(lines: readonly string[]): void {
    this.#tables.write(lines.map((line) => `${line}\n`).join(""));
  }
}
