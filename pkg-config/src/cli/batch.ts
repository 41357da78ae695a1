/** Runs a batch of cases and records each result. A batch can be interrupted and resumed. */
import { availableParallelism } from "node:os";
import { setFlagsFromString } from "node:v8";
import { autoWorkers, MAX_WORKERS } from "../aligner/aligner-options.js";
import { listed } from "../case-files.js";
import type { FoundFiles } from "../case-folder.js";
import { type Aligner, type AlignInput, createAligner, type Progress } from "../index.js";
import { type Checksums, withChecksums } from "../read-files.js";
import { type Entry, errorsIn, failureEntry, intakeLines, isFailure } from "./entry.js";
import { UsageError } from "./files.js";
import { caseSettings, type Flags } from "./flags.js";
import { flagName } from "./option-flags.js";
import { Output } from "./output.js";
import { OutputError } from "./output-file.js";
import { Pictures } from "./pictures.js";
import { BatchProgress, StatusLine } from "./progress.js";
import type { CaseKey, RecordHeader } from "./record.js";
import type { EntrySink } from "./result-files.js";
import type { RunFiles } from "./run-files.js";
import { note, type Style } from "./terminal.js";

/** Has V8 optimise WebAssembly later than by default: in a process of one case, compiling takes longer than it saves. */
function optimiseLater(): void {
  try {
    setFlagsFromString("--wasm-tiering-budget=50000000");
  } catch {
    // Other runtimes than Node have no flags of V8.
  }
}

/** The context in which a command works on a case. */
export interface CaseRun {
  /** The files of the case, set by the command once it has found them; the entry of a failure has them. */
  found: FoundFiles | undefined;
  readonly style: Style;
  /** Whether the reader of the output has closed it. */
  isClosed(): boolean;
  /** Shows the progress; only for a single case. */
  onProgress?: (progress: Progress) => void;
  /** Prints lines: at once for a single case, otherwise when the case is done. */
  print(...lines: string[]): void;
  /** Keeps the entry so far, which is written if the batch is interrupted. */
  partial(entry: Entry): void;
  /** Makes files of the case, without all of which it is not recorded as done. */
  make(files: () => Promise<void>): Promise<void>;
}

/** Lines for people about an entry. */
export interface CaseLines {
  /** Rows in the table of several cases. */
  rows?: readonly string[];
  /** Printed at the end: details of a single case, or warnings and failures. */
  remarks?: readonly string[];
}

/** The cases of a command, and the functions that work on them. */
export interface Job<T extends CaseKey> {
  tasks: readonly T[];
  /** The folders of the inputs; if they are deep, files at any depth are read. */
  folders: readonly string[];
  isDeep?: boolean;
  /** Works on a case and returns its entry. A `UsageError` ends the batch; other errors make the case a failure. */
  run(aligner: Aligner, task: T, caseRun: CaseRun): Promise<Entry>;
  /** Lines about an entry; by default, those of failures. */
  lines?(task: T, entry: Entry, isOnly: boolean, style: Style): CaseLines;
  /** Reads the inputs of the poses of an entry, by their names, for pictures. */
  inputs?(task: T, entry: Entry): Promise<ReadonlyMap<string, AlignInput>>;
  /** Whether the output files of `run` exist; by default, it has none. */
  isComplete?(): boolean;
  /** Further outputs. */
  sinks?: EntrySink[];
  /** The flags of the batch, if these are not all of the command line. */
  flags?: Flags;
  /** Runs after the batch. */
  after?(): Promise<void>;
}

/** The lines of a failure. */
export function failedLines(name: string, entry: Entry, style: Style): string[] {
  if (!isFailure(entry)) return [];
  const { code, message, file } = entry.error;
  return [`${style.red("failed ")}${name}: ${code}: ${message}`, ...(file === undefined ? [] : [`  in ${file}`])];
}

/** Items that are read while several workers are busy. One worker does the items in their order. */
const READ_AHEAD = 2;

/**
 * Works on each case that is not in the record, and writes and prints the results.
 * @param header the settings of the record
 * @returns whether all cases succeeded, and all their files are there
 */
export async function runBatch<T extends CaseKey>(
  job: Job<T>,
  commandLine: Flags,
  files: RunFiles,
  header: RecordHeader,
): Promise<boolean> {
  const { flags = commandLine } = job;
  const output = new Output(flags, job.sinks ?? [], files, header);
  let isWhole = false;
  try {
    isWhole = await new Batch(job, flags, files, output).run();
  } catch (error) {
    // What is done is kept, unless the command line is wrong.
    if (error instanceof UsageError) output.discard();
    else output.end();
    throw error;
  }
  await job.after?.();
  return isWhole;
}

/** The run of a job: what has been done, and what is printed about it. */
class Batch<T extends CaseKey> {
  readonly #isOnly: boolean;
  readonly #pictures: Pictures;
  readonly #remarks: string[] = [];
  /** Lines about the files of cases, and the names of these. */
  readonly #intake = new Map<string, string[]>();
  /** Cases of the record that had failed. */
  readonly #failedBefore: string[] = [];
  #done = 0;
  #failed = 0;
  #incomplete = 0;
  #progress: BatchProgress | undefined;

  constructor(
    private readonly job: Job<T>,
    private readonly flags: Flags,
    files: RunFiles,
    private readonly output: Output,
  ) {
    this.#isOnly = job.tasks.length === 1;
    this.#pictures = Pictures.open(flags, files);
  }

  /** Runs all cases. Returns whether all succeeded and have all their files. */
  async run(): Promise<boolean> {
    const { job, flags, output } = this;
    // Until all earlier cases are there, the files would hold less than before: they stay as they are.
    const left = flags.resume ? await this.#resume().finally(onInterruption(() => output.discard())) : job.tasks;
    const { workers = "auto" } = flags;
    if (this.#isOnly) optimiseLater();
    // A single case is done on this thread, unless the flags ask for workers.
    const wanted = workers === "auto" ? (this.#isOnly ? 0 : autoWorkers(availableParallelism())) : workers;
    const size = Math.min(wanted, this.#isOnly ? MAX_WORKERS : left.length, MAX_WORKERS);

    const stop = onInterruption(() => this.#interrupt());
    try {
      if (left.length > 0) await this.#runOn(left, size);
    } finally {
      stop();
      this.#progress?.clear();
    }
    this.#end();
    return this.#failed === 0 && this.#incomplete === 0;
  }

  async #runOn(tasks: readonly T[], workers: number): Promise<void> {
    const aligner = await createAligner({ workers });
    try {
      if (!this.#isOnly) this.#progress = new BatchProgress(process.stderr, tasks.length);
      const limit = workers > 1 ? workers + READ_AHEAD : 1;
      for await (const write of concurrently(tasks, limit, (task) => this.#runCase(aligner, task))) {
        write();
        if (this.output.isClosed) break;
      }
    } finally {
      aligner.dispose();
    }
  }

  /** Adds the cases that were done before, and returns the others. */
  async #resume(): Promise<T[]> {
    const { job, flags, output } = this;
    const resumed = new Set<T>();
    let [recorded, changed] = [0, 0];
    const isChanged = () => {
      changed += 1;
    };
    for await (const { task, name, path, entry } of output.resumed(job.tasks, isChanged)) {
      recorded += 1;
      if (task !== undefined && !isFailure(entry) && job.isComplete?.() === false) continue;
      output.add(name, entry, path);
      if (task === undefined) continue;

      resumed.add(task);
      if (!(await this.#draw(task, entry, true))) this.#incomplete += 1;
      const [error] = this.#count(name, entry);
      if (error !== undefined) this.#failedBefore.push(`${name} (${error})`);
    }
    if (recorded + changed > 0) {
      const fresh = job.tasks.length - resumed.size - changed;
      const others = [
        ...(changed > 0 ? [`${changed} changed since, and done again`] : []),
        ...(fresh > 0 ? [`${fresh} new`] : []),
      ];
      const more = others.length === 0 ? "" : `; ${others.join("; ")}`;
      note(`resumed: ${resumed.size} of ${job.tasks.length} cases are in ${flags.jsonl}${more}`);
    }
    return job.tasks.filter((task) => !resumed.has(task));
  }

  /** Works on a case. Returns a function that writes the result. */
  async #runCase(aligner: Aligner, task: T): Promise<() => void> {
    const { job, output } = this;
    const early: string[] = [];
    const line = this.#isOnly ? new StatusLine(process.stderr) : undefined;
    const show = (state: string) => line?.show(`[1/1] ${task.name}  ${state}`);
    let isComplete = true;
    const caseRun: CaseRun = {
      ...{ found: undefined, style: output.style, isClosed: () => output.isClosed },
      print(...lines) {
        line?.clear();
        if (line === undefined) early.push(...lines);
        else output.lines(lines);
      },
      partial: (entry) => line && output.begin(task.name, entry, task.path),
      make: async (files) => {
        if (!(await this.#make(task, files))) isComplete = false;
      },
    };
    if (this.#isOnly)
      caseRun.onProgress = ({ stage, fraction }) =>
        show(`${String(Math.floor(100 * fraction)).padStart(3)} %  ${stage}`);

    show("reading");
    const read: Checksums = new Map();
    const work = withChecksums(read, () => job.run(aligner, task, caseRun)).catch((error) => {
      // An error about a flag is one of usage; of several cases, the flag may be right for others.
      if (this.#isOnly && Object.hasOwn(caseSettings(this.flags), error.argument)) {
        const { argument, message } = error;
        throw new UsageError(message.replace(argument, `--${flagName({ name: argument })}`));
      }
      return failureEntry(error, caseRun.found);
    });
    const entry = await work.finally(() => line?.clear());
    // Before the record: a case that is there has all its files.
    if (!(await this.#draw(task, entry, false))) isComplete = false;
    return () => this.#write(task, entry, isComplete, early, read);
  }

  /** Writes the result of a case. `early` are lines that were printed before. */
  #write(task: T, entry: Entry, isComplete: boolean, early: readonly string[], read: Checksums): void {
    const { output } = this;
    const hasErrors = this.#count(task.name, entry).length > 0;
    if (isComplete) output.record(task, entry, read);
    else this.#incomplete += 1;
    output.add(task.name, entry, task.path);

    for (const line of intakeLines(entry)) this.#intake.set(line, [...(this.#intake.get(line) ?? []), task.name]);
    const { rows = [], remarks = [] } = this.#linesOf(task, entry);
    this.#remarks.push(...remarks);
    this.#progress?.clear();
    output.lines([...early, ...rows]);
    this.#progress?.add(hasErrors || !isComplete);
  }

  #linesOf(task: T, entry: Entry): CaseLines {
    const { job, output } = this;
    if (job.lines !== undefined) return job.lines(task, entry, this.#isOnly, output.style);
    return isFailure(entry) ? { [this.#isOnly ? "remarks" : "rows"]: failedLines(task.name, entry, output.style) } : {};
  }

  /** Counts a case, and adds its rows to the report. Returns its errors. */
  #count(name: string, entry: Entry): string[] {
    const errors = errorsIn(entry);
    this.#done += 1;
    if (errors.length > 0) this.#failed += 1;
    this.#pictures.record(name, entry);
    return errors;
  }

  async #draw(task: T, entry: Entry, isResumed: boolean): Promise<boolean> {
    const { inputs } = this.job;
    if (inputs === undefined) return true;
    return this.#make(task, () => this.#pictures.draw(task.name, entry, isResumed, () => inputs(task, entry)));
  }

  /** Makes files of a case. Returns whether all are there. */
  async #make(task: T, make: () => Promise<void>): Promise<boolean> {
    try {
      await make();
      return true;
    } catch (error) {
      if (!(error instanceof OutputError)) throw error;
      this.#progress?.clear();
      note(`error: ${task.name}: ${error.message}`);
      return false;
    }
  }

  /** Closes the files and prints the remarks. */
  #end(): void {
    const [remarks, failedBefore] = [this.#remarks, this.#failedBefore];
    this.#progress?.clear();
    this.output.end();
    this.#pictures.end();
    this.output.lines(!this.#isOnly && remarks.length > 0 ? ["", ...remarks] : remarks);

    const lines = [...this.#intake].map(([line, names]) => (this.#isOnly ? line : `${line} (${listed(names)})`));
    if (lines.length > 0) this.output.lines(["", ...lines]);
    if (failedBefore.length > 0)
      note(`failed earlier: ${listed(failedBefore)}; remove their lines from the record to try again`);
  }

  #interrupt(): void {
    try {
      this.#end();
    } catch (error) {
      note(`error: ${(error as Error).message}`);
    }
    const { json, jsonl = "-", csv } = this.flags;
    const files = [jsonl, json, csv].filter((path) => path !== undefined && path !== "-");
    const place = files.length === 0 ? "" : `; they are in ${files.join(", ")}`;
    note(`interrupted: ${this.#done} of ${this.job.tasks.length} cases are done${place}`);
    const remedy = "With --jsonl FILE, a batch can be resumed: --resume skips the cases in the file.";
    if (!this.#isOnly) note(jsonl === "-" ? remedy : "To go on, run the same command with --resume.");
  }
}

/** Runs a task for each item, at most `limit` at a time, and yields the results as the tasks finish. */
async function* concurrently<T, R>(items: Iterable<T>, limit: number, run: (item: T) => Promise<R>) {
  const iterator = items[Symbol.iterator]();
  const running = new Set<Promise<() => R>>();
  for (;;) {
    while (running.size < limit) {
      const next = iterator.next();
      if (next.done) break;
      const task: Promise<() => R> = run(next.value).then((result) => () => {
        running.delete(task);
        return result;
      });
      running.add(task);
    }
    if (running.size === 0) return;
    yield (await Promise.race(running))();
  }
}

const signals = ["SIGINT", "SIGTERM"] as const;

/** Calls `act` when the program is interrupted, before it ends; until the returned function is called. */
function onInterruption(act: () => void): () => void {
  const stop = () => {
    for (const signal of signals) process.off(signal, end);
  };
  const end = (signal: NodeJS.Signals) => {
    stop();
    act();
    // Ends the program as the signal would have: a shell that runs a list of commands stops, too.
    process.kill(process.pid, signal);
  };
  for (const signal of signals) process.on(signal, end);
  return stop;
}
