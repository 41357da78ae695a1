/** A batch: what is done, and what is written of it. */
import { BatchProgress } from "./batch-progress.js";
import { type Outcome, outcomeJson } from "./outcome.js";
import type { Output, OutputFlags } from "./output.js";
import { type Pictures, shownIn } from "./pictures.js";
import { details, notes, viewsDetails } from "./report.js";

/** Writes the result of each case when it is done, and what concerns all of them at the end. */
export class Batch {
  readonly #total: number;
  readonly #output: Output;
  readonly #flags: OutputFlags;
  readonly #pictures: Pictures;
  /** Printed at the end: details of a single case, or warnings and failures. */
  readonly #remarks: string[] = [];
  #progress: BatchProgress | undefined;
  #done = 0;
  #failed = 0;

  constructor(total: number, output: Output, pictures: Pictures, flags: OutputFlags) {
    this.#total = total;
    this.#output = output;
    this.#pictures = pictures;
    this.#flags = flags;
  }

  get hasFailure(): boolean {
    return this.#failed > 0;
  }

  /** Counts a case that was done before. */
  skip(isFailure: boolean): void {
    this.#done += 1;
    if (isFailure) this.#failed += 1;
  }

  /** Shows the progress of the cases that are left. */
  begin(left: number): void {
    this.#progress = new BatchProgress(process.stderr, left, () => performance.now());
    this.#progress.draw();
  }

  /**
   * Writes the result of a case.
   * @param rows its rows of the table
   */
  add(outcome: Outcome, rows: readonly string[]): void {
    const isFailure = "error" in outcome;
    this.skip(isFailure);
    const entry = outcomeJson(outcome);
    this.#output.add(outcome.name, entry);
    this.picture(outcome.name, entry);
    this.#remarks.push(...remarks(outcome, this.#total === 1, this.#output));
    this.#progress?.clear();
    this.#output.lines(rows);
    this.#progress?.add(isFailure);
  }

  /** Adds the rows of a case to the report. */
  picture(name: string, entry: object): void {
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
    this.#output.lines(isSeparate ? ["", ...this.#remarks] : this.#remarks);
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

/** What follows the table: details of a single case, or the warnings and the failure of one of several. */
function remarks(outcome: Outcome, isSingle: boolean, { style }: Output): string[] {
  if (!isSingle || "error" in outcome) return notes([outcome], style);
  return "views" in outcome ? viewsDetails(outcome, style) : details(outcome, style);
}
