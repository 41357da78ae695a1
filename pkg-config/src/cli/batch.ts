/** A batch: what is done, and what is written of it. */
import { isRecord } from "../values/values.js";
import { BatchProgress } from "./batch-progress.js";
import type { CaseKey } from "./jsonl-file.js";
import { isMetric, noUnitNote } from "./lengths.js";
import type { Output, OutputFlags } from "./output.js";
import { type Pictures, shownIn } from "./pictures.js";

/** An item that is done. */
export interface Done {
  key: CaseKey;
  /** Its JSON entry. */
  entry: object;
  /** Its rows of the table of a batch. */
  rows: readonly string[];
  /** Printed at the end: details of a single item, or warnings and failures. */
  remarks: readonly string[];
}

/** The codes of the errors in an entry: its own, and those of its frames or objects. */
export function errorsIn(entry: object): string[] {
  const { error, frames, objects } = entry as Readonly<Record<string, unknown>>;
  if (isRecord(error)) return [String(error.code)];
  return [frames, objects].filter(isRecord).flatMap((parts) => Object.values(parts).filter(isRecord).flatMap(errorsIn));
}

/** Failures of an earlier run that are named. */
const NAMED = 10;

/** Writes the result of each case when it is done, and what concerns all of them at the end. */
export class Batch {
  readonly #total: number;
  readonly #output: Output;
  readonly #flags: OutputFlags;
  readonly #pictures: Pictures;
  readonly #remarks: string[] = [];
  /** What failed in the run that is resumed. */
  readonly #failedBefore: string[] = [];
  #progress: BatchProgress | undefined;
  #done = 0;
  #failed = 0;
  /** Whether a result has lengths without a unit. */
  #hasNoUnit = false;

  constructor(total: number, output: Output, pictures: Pictures, flags: OutputFlags) {
    this.#total = total;
    this.#output = output;
    this.#pictures = pictures;
    this.#flags = flags;
  }

  get hasFailure(): boolean {
    return this.#failed > 0;
  }

  /** Adds a case that was done before. */
  resume(name: string, entry: object): void {
    const [error] = this.#count(entry);
    if (error !== undefined) this.#failedBefore.push(`${name} (${error})`);
    this.#picture(name, entry);
  }

  #count(entry: object): string[] {
    const errors = errorsIn(entry);
    this.#done += 1;
    this.#hasNoUnit ||= !isMetric(entry);
    if (errors.length > 0) this.#failed += 1;
    return errors;
  }

  /** Shows the progress of the cases that are left. */
  begin(left: number): void {
    this.#progress = new BatchProgress(process.stderr, left, () => performance.now());
    this.#progress.draw();
  }

  /** Writes the result of a case. */
  add({ key, entry, rows, remarks }: Done): void {
    const isFailure = this.#count(entry).length > 0;
    this.#output.add(key, entry);
    this.#picture(key.name, entry);
    this.#remarks.push(...remarks);
    this.#progress?.clear();
    this.#output.lines(rows);
    this.#progress?.add(isFailure);
  }

  /** Adds the rows of a case to the report. */
  #picture(name: string, entry: object): void {
    for (const shown of shownIn(name, entry)) this.#pictures.record(shown.name, shown.entry);
  }

  /** Clears the progress. */
  clear(): void {
    this.#progress?.clear();
  }

  /** Closes the files and prints the remarks. */
  end(): void {
    this.clear();
    this.#output.end();
    this.#pictures.end();
    const isSeparate = this.#total > 1 && this.#remarks.length > 0;
    const remarks = isSeparate ? ["", ...this.#remarks] : this.#remarks;
    this.#output.lines(this.#hasNoUnit ? [...remarks, "", noUnitNote] : remarks);
    const before = this.#failedBefore;
    if (before.length === 0) return;
    const more = before.length > NAMED ? ` and ${before.length - NAMED} more` : "";
    console.error(
      `failed earlier: ${before.slice(0, NAMED).join(", ")}${more}; remove their lines from the record to try again`,
    );
  }

  /** Ends the batch, and says how to go on. */
  interrupt(): void {
    this.end();
    const { json, jsonl, csv } = this.#flags;
    const files = [jsonl, json, csv].filter((path) => path !== undefined && path !== "-");
    const place = files.length === 0 ? "" : `; they are in ${files.join(", ")}`;
    console.error(`interrupted: ${this.#done} of ${this.#total} cases are done${place}`);
    if (this.#total === 1) return;
    const isRecorded = jsonl !== undefined && jsonl !== "-";
    console.error(
      isRecorded
        ? "To go on, run the same command with --resume."
        : "With --jsonl FILE, a batch can be resumed: --resume skips the cases in the file.",
    );
  }
}
