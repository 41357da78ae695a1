/** Output of the commands. */
import { resolve } from "node:path";
import { CsvFile } from "./csv-file.js";
import { type CaseKey, JsonlFile, type RecordedEntry } from "./jsonl-file.js";
import { ResultsFile } from "./results-file.js";
import { Style } from "./style.js";
import { UsageError } from "./usage-error.js";

/** The flags that name files; "-" is stdout. */
export interface OutputFlags {
  json?: string;
  jsonl?: string;
  csv?: string;
  /** Whether the cases in the file of `jsonl` are done. */
  resume?: boolean;
}

/** What gets the entries of cases, in another format. */
export interface EntrySink {
  add(name: string, entry: object): void;
  /** Writes what is not written yet. */
  end(): void;
}

/** Writes the entries of cases to files, and tables to stdout; to stderr, if stdout gets entries. */
export class Output {
  readonly #json: ResultsFile | undefined;
  readonly #jsonl: JsonlFile | undefined;
  readonly #sinks: readonly EntrySink[];
  readonly #tables: NodeJS.WriteStream;
  /** Text style of the tables. */
  readonly style: Style;
  #isClosed = false;

  /** @throws {@link UsageError} if a file cannot be written */
  constructor({ json, jsonl, csv, resume = false }: OutputFlags, sinks: readonly EntrySink[] = []) {
    checkDistinct({ json, jsonl, csv });
    if (resume && jsonl === undefined) throw new UsageError("--resume needs --jsonl FILE, the record of what is done.");
    this.#json = json === undefined ? undefined : new ResultsFile(json);
    this.#jsonl = jsonl === undefined ? undefined : new JsonlFile(jsonl, resume);
    this.#sinks = csv === undefined ? sinks : [new CsvFile(csv), ...sinks];
    this.#tables = [json, jsonl, csv].includes("-") ? process.stderr : process.stdout;
    this.style = new Style(this.#tables);
    this.#tables.on("error", () => {
      this.#isClosed = true;
    });
  }

  /** Whether nothing will be read any more: "| head" has ended, and there is no file. */
  get isClosed(): boolean {
    return this.#isClosed && this.#json === undefined && this.#jsonl === undefined && this.#sinks.length === 0;
  }

  /**
   * Adds the entry of a case.
   * @param isFinal whether no other entry will replace it; others are written to the file of `json` only
   */
  add(key: CaseKey, entry: object, isFinal = true): void {
    const { name } = key;
    // First the record from which the others can be written again.
    if (isFinal) this.#jsonl?.add(key, entry);
    this.#json?.add(name, entry, isFinal);
    if (!isFinal) return;
    for (const sink of this.#sinks) sink.add(name, entry);
  }

  /** The entries of the record, before it is written. */
  recorded(): AsyncIterable<RecordedEntry> | readonly RecordedEntry[] {
    return this.#jsonl?.entries() ?? [];
  }

  /** Adds an entry of the record to the other files. */
  addRecorded(name: string, entry: object): void {
    this.#json?.add(name, entry);
    for (const sink of this.#sinks) sink.add(name, entry);
  }

  /** Writes what is not written yet, and closes the files. */
  end(): void {
    this.#json?.end();
    this.#jsonl?.end();
    for (const sink of this.#sinks) sink.end();
  }

  /** Writes human-readable lines. */
  lines(lines: readonly string[]): void {
    this.#tables.write(lines.map((line) => `${line}\n`).join(""));
  }
}

/** @throws {@link UsageError} if two flags name one file */
function checkDistinct(flags: Readonly<Record<string, string | undefined>>): void {
  const owners = new Map<string, string>();
  for (const [flag, path] of Object.entries(flags)) {
    if (path === undefined) continue;
    const file = path === "-" ? path : resolve(path);
    const other = owners.get(file);
    if (other !== undefined) throw new UsageError(`--${other} and --${flag} name the same file: ${path}.`);
    owners.set(file, flag);
  }
}
