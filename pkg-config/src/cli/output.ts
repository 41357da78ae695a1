/** The outputs of a batch: JSON, a record, comma-separated values, and text for people. */
import type { Checksums } from "../read-files.js";
import type { Entry } from "./entry.js";
import type { Flags } from "./flags.js";
import { type CaseKey, JsonlFile, type RecordHeader, type Resumed, relativeTo } from "./record.js";
import { CsvFile, type EntrySink, ResultsFile } from "./result-files.js";
import type { RunFiles } from "./run-files.js";
import { Style } from "./terminal.js";

/** Writes the entries of cases to files, and tables to stdout; to stderr, if stdout gets entries. */
export class Output {
  readonly #record: JsonlFile | undefined;
  readonly #sinks: readonly EntrySink[];
  readonly #tables: NodeJS.WriteStream;
  /** The entry so far of a case that is not done. */
  #begun: Parameters<EntrySink["add"]> | undefined;
  /** Text style of the tables. */
  readonly style: Style;
  #isClosed = false;
  #isEnded = false;

  /** @throws {@link UsageError} if the record cannot be continued */
  constructor(
    { json, jsonl, csv, resume = false }: Pick<Flags, "json" | "jsonl" | "csv" | "resume">,
    sinks: EntrySink[],
    files: RunFiles,
    header: RecordHeader,
  ) {
    this.#record = jsonl === undefined ? undefined : new JsonlFile(jsonl, resume, header);
    this.#sinks = [
      ...(json === undefined ? [] : [new ResultsFile(files.open({ flag: "--json", path: json }), relativeTo(json))]),
      ...(csv === undefined ? [] : [new CsvFile(files.open({ flag: "--csv", path: csv }))]),
      ...sinks,
    ];
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
  resumed<T extends CaseKey>(
    tasks: readonly T[],
    changed: (task: T) => void,
  ): AsyncIterable<Resumed<T>> | readonly Resumed<T>[] {
    return this.#record?.resumed(tasks, changed) ?? [];
  }

  /** Adds the entry of a case to the record. */
  record(key: CaseKey, entry: Entry, read: Checksums): void {
    this.#record?.add(key, entry, read);
  }

  /** Adds the entry of a case to the other files. */
  add(name: string, entry: Entry, path?: string): void {
    this.#begun = undefined;
    for (const sink of this.#sinks) sink.add(name, entry, path);
  }

  /** Keeps the entry so far of a case, which the files get if the batch ends before it. */
  begin(...entry: Parameters<EntrySink["add"]>): void {
    this.#begun = entry;
  }

  /** Writes what is not written yet, and closes the files. All are closed, before the first error is thrown. */
  end(): void {
    if (this.#isEnded) return;
    this.#isEnded = true;
    if (this.#begun !== undefined) this.add(...this.#begun);
    const errors: unknown[] = [];
    for (const file of [this.#record, ...this.#sinks]) {
      try {
        file?.end();
      } catch (error) {
        errors.push(error);
      }
    }
    if (errors.length > 0) throw errors[0];
  }

  /** Closes the files, which keep their earlier content. */
  discard(): void {
    this.#record?.end();
    for (const sink of this.#sinks) sink.discard?.();
  }

  /** Writes human-readable lines. */
  lines(lines: readonly string[]): void {
    this.#tables.write(lines.map((line) => `${this.style.printable(line)}\n`).join(""));
  }
}
