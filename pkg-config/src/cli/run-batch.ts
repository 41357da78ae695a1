/** The loop of all commands that work on many folders. */
import { availableParallelism } from "node:os";
import { MAX_WORKERS } from "../aligner/aligner-options.js";
import { type Aligner, createAligner, type Progress } from "../index.js";
import { Batch, type Done } from "./batch.js";
import type { BatchFlags } from "./batch-flags.js";
import { concurrently } from "./concurrent.js";
import { onInterruption } from "./interruption.js";
import type { CaseKey } from "./jsonl-file.js";
import type { Output } from "./output.js";
import { type PictureFlags, Pictures } from "./pictures.js";
import { resumedEntries } from "./record.js";
import { StatusLine } from "./status-line.js";

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
  const resumed = new Set<T>();
  if (flags.resume) {
    let recorded = 0;
    for await (const { task, name, entry } of resumedEntries(output, tasks)) {
      recorded += 1;
      output.addRecorded(name, entry);
      if (task === undefined) continue;
      resumed.add(task);
      await work.draw?.(pictures, task, entry, true);
      batch.resume(name, entry);
    }
    if (recorded > 0) console.error(`resumed: ${resumed.size} of ${tasks.length} cases are in ${flags.jsonl}`);
  }
  const left = tasks.filter((task) => !resumed.has(task));
  const { workers = "auto" } = flags;
  // A single item is done on this thread, unless the flags ask for workers.
  const auto = tasks.length > 1 ? availableParallelism() : 0;
  const size = Math.min(workers === "auto" ? auto : workers, tasks.length > 1 ? left.length : MAX_WORKERS, MAX_WORKERS);
  const run = async (aligner: Aligner, task: T): Promise<Done> => {
    const live = tasks.length > 1 ? undefined : liveOf(task, output);
    const done = await work.run(aligner, task, live).finally(() => live?.clear());
    // Before the record: what is there needs no other pictures.
    await work.draw?.(pictures, task, done.entry, false);
    return live === undefined ? done : { ...done, rows: [] };
  };
  const stop = onInterruption(() => batch.interrupt());
  let aligner: Aligner | undefined;
  try {
    if (left.length > 0) {
      const own = await createAligner({ workers: size });
      aligner = own;
      if (tasks.length > 1) batch.begin(left.length);
      for await (const done of concurrently(left, size > 1 ? size + READ_AHEAD : 1, (task) => run(own, task))) {
        batch.add(done);
        if (output.isClosed) break;
      }
    }
  } finally {
    aligner?.dispose();
    stop();
    batch.clear();
  }
  batch.end();
  if (batch.hasFailure) process.exitCode = 1;
}

/** What the only item of a batch shows, with a line for its progress. */
function liveOf(task: CaseKey, output: Output): Live & { clear(): void } {
  const line = new StatusLine(process.stderr);
  const show = (state: string) => line.show(`[1/1] ${task.name}  ${state}`);
  show("reading");
  return {
    progress: ({ stage, fraction }) => show(`${String(Math.floor(100 * fraction)).padStart(3)} %  ${stage}`),
    partial: (entry) => output.add(task, entry, false),
    lines(lines) {
      line.clear();
      output.lines(lines);
    },
    clear: () => line.clear(),
  };
}
