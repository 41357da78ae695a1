/** Runs a batch of cases and records each result. A batch can be interrupted and resumed. */
import { availableParallelism } from "node:os";
import { autoWorkers, MAX_WORKERS } from "../aligner/aligner-options.js";
import { listed } from "../case-files.js";
import type { FoundFiles } from "../case-folder.js";
import { type Aligner, type AlignInput, createAligner, type Progress } from "../index.js";
import { type Entry, errorsIn, failureEntry, intakeLines, isFailure } from "./entry.js";
import { UsageError } from "./files.js";
import type { Flags } from "./flags.js";
import { Output } from "./output.js";
import { OutputError } from "./output-file.js";
import { Pictures } from "./pictures.js";
import { BatchProgress, StatusLine } from "./progress.js";
import type { CaseKey, RecordHeader } from "./record.js";
import type { EntrySink } from "./result-files.js";
import type { RunFiles } from "./run-files.js";
import { note, type Style } from "./terminal.js";

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
    isWhole = await runCases(job, flags, files, output);
  } catch (error) {
    // What is done is kept, unless the command line is wrong.
    if (error instanceof UsageError) output.discard();
    else output.end();
    throw error;
  }
  await job.after?.();
  return isWhole;
}

async function runCases<T extends CaseKey>(
  job: Job<T>,
  flags: Flags,
  files: RunFiles,
  output: Output,
): Promise<boolean> {
  const { tasks } = job;
  const pictures = await Pictures.open(flags, files);
  const { style } = output;
  const isOnly = tasks.length === 1;
  const remarks: string[] = [];
  const failedBefore: string[] = [];
  let [done, failed, incomplete] = [0, 0, 0];
  /** Lines about the files of cases, and these. */
  const intake = new Map<string, string[]>();
  let progress: BatchProgress | undefined;

  /** Counts a case, and adds its rows to the report. Returns its errors. */
  const count = (name: string, entry: Entry): string[] => {
    const errors = errorsIn(entry);
    done += 1;
    if (errors.length > 0) failed += 1;
    pictures.record(name, entry);
    return errors;
  };
  /** Makes files of a case. Returns whether all are there. */
  const makes = async (task: T, make: () => Promise<void>): Promise<boolean> => {
    try {
      await make();
      return true;
    } catch (error) {
      if (!(error instanceof OutputError)) throw error;
      progress?.clear();
      note(`error: ${task.name}: ${error.message}`);
      return false;
    }
  };
  const draw = (task: T, entry: Entry, isResumed: boolean) =>
    makes(task, async () => {
      const { inputs } = job;
      if (inputs !== undefined) await pictures.draw(task.name, entry, isResumed, () => inputs(task, entry));
    });
  /** Adds the cases that were done before, and returns the others. */
  const resume = async (): Promise<T[]> => {
    const resumed = new Set<T>();
    let recorded = 0;
    for await (const { task, name, entry } of output.resumed(tasks)) {
      recorded += 1;
      if (task !== undefined && !isFailure(entry) && job.isComplete?.() === false) continue;
      output.add(name, entry);
      if (task === undefined) continue;
      resumed.add(task);
      if (!(await draw(task, entry, true))) incomplete += 1;
      const [error] = count(name, entry);
      if (error !== undefined) failedBefore.push(`${name} (${error})`);
    }
    if (recorded > 0) note(`resumed: ${resumed.size} of ${tasks.length} cases are in ${flags.jsonl}`);
    return tasks.filter((task) => !resumed.has(task));
  };
  const linesOf = (task: T, entry: Entry): CaseLines => {
    if (job.lines !== undefined) return job.lines(task, entry, isOnly, style);
    return isFailure(entry) ? { [isOnly ? "remarks" : "rows"]: failedLines(task.name, entry, style) } : {};
  };
  /** Works on a case. Returns a function that writes the result. */
  const run = async (aligner: Aligner, task: T): Promise<() => void> => {
    const early: string[] = [];
    const line = isOnly ? new StatusLine(process.stderr) : undefined;
    let isComplete = true;
    const show = (state: string) => line?.show(`[1/1] ${task.name}  ${state}`);
    const caseRun: CaseRun = {
      ...{ found: undefined, style, isClosed: () => output.isClosed },
      print(...lines) {
        line?.clear();
        if (line === undefined) early.push(...lines);
        else output.lines(lines);
      },
      partial: (entry) => line && output.begin(task.name, entry),
      async make(files) {
        if (!(await makes(task, files))) isComplete = false;
      },
    };
    if (isOnly)
      caseRun.onProgress = ({ stage, fraction }) =>
        show(`${String(Math.floor(100 * fraction)).padStart(3)} %  ${stage}`);
    show("reading");
    const work = job.run(aligner, task, caseRun).catch((error) => failureEntry(error, caseRun.found));
    const entry = await work.finally(() => line?.clear());
    // Before the record: a case that is there has all its files.
    if (!(await draw(task, entry, false))) isComplete = false;
    return () => {
      const hasErrors = count(task.name, entry).length > 0;
      if (isComplete) output.record(task, entry);
      else incomplete += 1;
      output.add(task.name, entry);
      for (const line of intakeLines(entry)) intake.set(line, [...(intake.get(line) ?? []), task.name]);
      const { rows = [], remarks: more = [] } = linesOf(task, entry);
      remarks.push(...more);
      progress?.clear();
      output.lines([...early, ...rows]);
      progress?.add(hasErrors || !isComplete);
    };
  };
  /** Closes the files and prints the remarks. */
  const end = () => {
    progress?.clear();
    output.end();
    pictures.end();
    output.lines(!isOnly && remarks.length > 0 ? ["", ...remarks] : remarks);
    const lines = [...intake].map(([line, names]) => (isOnly ? line : `${line} (${listed(names)})`));
    if (lines.length > 0) output.lines(["", ...lines]);
    if (failedBefore.length > 0)
      note(`failed earlier: ${listed(failedBefore)}; remove their lines from the record to try again`);
  };
  const interrupt = () => {
    try {
      end();
    } catch (error) {
      note(`error: ${(error as Error).message}`);
    }
    const { json, jsonl = "-", csv } = flags;
    const files = [jsonl, json, csv].filter((path) => path !== undefined && path !== "-");
    const place = files.length === 0 ? "" : `; they are in ${files.join(", ")}`;
    note(`interrupted: ${done} of ${tasks.length} cases are done${place}`);
    const remedy = "With --jsonl FILE, a batch can be resumed: --resume skips the cases in the file.";
    if (!isOnly) note(jsonl === "-" ? remedy : "To go on, run the same command with --resume.");
  };

  // Until all earlier cases are there, the files would hold less than before: they stay as they are.
  const left = flags.resume ? await resume().finally(onInterruption(() => output.discard())) : tasks;
  const { workers = "auto" } = flags;
  // A single case is done on this thread, unless the flags ask for workers.
  const wanted = workers === "auto" ? (isOnly ? 0 : autoWorkers(availableParallelism())) : workers;
  const size = Math.min(wanted, isOnly ? MAX_WORKERS : left.length, MAX_WORKERS);
  const stop = onInterruption(interrupt);
  let aligner: Aligner | undefined;
  try {
    if (left.length > 0) {
      const created = await createAligner({ workers: size });
      aligner = created;
      if (!isOnly) progress = new BatchProgress(process.stderr, left.length);
      for await (const write of concurrently(left, size > 1 ? size + READ_AHEAD : 1, (task) => run(created, task))) {
        write();
        if (output.isClosed) break;
      }
    }
  } finally {
    aligner?.dispose();
    stop();
    progress?.clear();
  }
  end();
  return failed === 0 && incomplete === 0;
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
