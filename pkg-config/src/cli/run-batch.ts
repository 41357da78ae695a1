/** The loop of all commands that work on many folders. */
import { availableParallelism } from "node:os";
import { MAX_WORKERS } from "../aligner-options.js";
import { type Aligner, createAligner, type Progress } from "../index.js";
import { Batch, type Done } from "./batch.js";
import type { BatchFlags } from "./batch-flags.js";
import { concurrently } from "./concurrent.js";
import { onInterruption } from "./interruption.js";
import type { CaseKey } from "./jsonl-file.js";
import type { Output } from "./output.js";
import { type PictureFlags, Pictures } from "./pictures.js";
import { ProgressLine } from "./progress-line.js";
import { resumedEntries } from "./record.js";

/** What the only item of a batch shows while it is worked on. */
export interface Live {
  progress(state: Progress): void;
  /** Writes the entry so far. */
  partial(entry: object): void;
  lines(lines: readonly string[]): void;
}

/** What a command does. */
export interface Work<T extends CaseKey> {
  /** Only errors that concern all items are thrown, as {@link UsageError}. */
  run(aligner: Aligner, task: T, live?: Live): Promise<Done>;
  /** Draws the pictures of an entry; those that are there are kept if it is resumed. */
  draw?(pictures: Pictures, task: T, entry: object, isResumed: boolean): Promise<void>;
}

/** Items that are read while several workers are busy. One worker does the items in their order. */
const READ_AHEAD = 2;

/** Does the work for each item that is not in the record, and writes and prints the results. */
export async function runBatch<T extends CaseKey>(
  tasks: readonly T[],
  flags: BatchFlags & PictureFlags,
  output: Output,
  work: Work<T>,
): Promise<void> {
  const pictures = await Pictures.open(flags);
  const batch = new Batch(tasks.length, output, pictures, flags);
  const done = new Set<T>();
  if (flags.resume) {
    for await (const { task, name, entry } of resumedEntries(output, tasks)) {
      output.addRecorded(name, entry);
      if (task === undefined) continue;
      done.add(task);
      await work.draw?.(pictures, task, entry, true);
      batch.resume(name, entry);
    }
    console.error(`resumed: ${done.size} of ${tasks.length} cases are in ${flags.jsonl}`);
  }
  const left = tasks.filter((task) => !done.has(task));
  const stop = onInterruption(() => batch.interrupt());
  try {
    if (tasks.length > 1) await doMany(left, flags, batch, output, pictures, work);
    else if (left.length > 0) await doOne(left[0] as T, flags, batch, output, pictures, work);
  } finally {
    stop();
    batch.clear();
  }
  batch.end();
  if (batch.hasFailure) process.exitCode = 1;
}

/** Does the only item, on this thread unless the flags ask for workers. */
async function doOne<T extends CaseKey>(
  task: T,
  flags: BatchFlags,
  batch: Batch,
  output: Output,
  pictures: Pictures,
  work: Work<T>,
): Promise<void> {
  const aligner = await createAligner({ workers: flags.workers === "auto" ? 0 : (flags.workers ?? 0) });
  const progress = new ProgressLine(process.stderr, 1);
  progress.begin(task.name);
  const live: Live = {
    progress: (state) => progress.update(state),
    partial: (entry) => output.add(task, entry, false),
    lines(lines) {
      progress.clear();
      output.lines(lines);
    },
  };
  try {
    const done = await work.run(aligner, task, live).finally(() => progress.clear());
    await work.draw?.(pictures, task, done.entry, false);
    batch.add({ ...done, rows: [] });
  } finally {
    aligner.dispose();
  }
}

/** Does items side by side. Each is read when its turn comes. */
async function doMany<T extends CaseKey>(
  tasks: readonly T[],
  { workers = "auto" }: BatchFlags,
  batch: Batch,
  output: Output,
  pictures: Pictures,
  work: Work<T>,
): Promise<void> {
  if (tasks.length === 0) return;
  const size = Math.min(workers === "auto" ? availableParallelism() : workers, tasks.length, MAX_WORKERS);
  const aligner = await createAligner({ workers: size });
  batch.begin(tasks.length);
  try {
    const run = async (task: T) => {
      const done = await work.run(aligner, task);
      // Before the record: what is there needs no other pictures.
      await work.draw?.(pictures, task, done.entry, false);
      return done;
    };
    for await (const done of concurrently(tasks, size === 1 ? 1 : size + READ_AHEAD, run)) {
      batch.add(done);
      if (output.isClosed) break;
    }
  } finally {
    aligner.dispose();
  }
}
