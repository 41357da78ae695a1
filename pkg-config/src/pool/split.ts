/**
 * One alignment, its search shared by several workers: each holds the input, does a part of every round's tasks, and is
 * told what came of all. The bits are those of an alignment by one (see `src/align/split.rs`).
 */
import type { Call } from "../engine.js";
import type { Job } from "../jobs.js";
import type { Alignment } from "../results.js";
import { buffersOf, copied } from "../transfer.js";
import { SEARCHED, type ShareRequest } from "./protocol.js";
import { JobFailed, Unsendable, WorkerLost, type WorkerSlot } from "./slot.js";

type AlignJob = Job & { method: "align" };

/** Progress after each step; the last one only takes what came of the last round. */
const ROUNDS = [0.35, 0.4, 0.55, 0.65, 0.72, SEARCHED, SEARCHED];

/** Whether a job's search has parts: that of `precise` has. */
export function canBeSplit(job: Job): job is AlignJob {
  if (job.method !== "align") return false;
  const { preset = "precise" } = job.options as { preset?: unknown };
  return preset === "precise";
}

/** The alignment; `null` where one worker alone has to do it, or to say what is wrong with it. */
export async function splitAlign(slots: readonly WorkerSlot[], job: AlignJob, call: Call): Promise<Alignment | null> {
  const [leader] = slots as [WorkerSlot];
  try {
    const began = performance.now();
    await every(slots, () => {
      const own = { ...job, data: copied(job.data) };
      return [{ type: "share", job: own }, buffersOf(own.data)];
    });
    const holders = slots.map((slot) => slot.worker);
    const prepared = performance.now();
    call.progress.report("search", 0.1);
    const ms = { prepare: prepared - began, search: 0, refine: 0 };
    let found: Float64Array | undefined;
    for (const done of ROUNDS) {
      const start = performance.now();
      const sharers = slots.map((slot, part) => fromHolder(slot, holders[part]));
      const answers = await every(sharers, (part) => [{ type: "step", found, part, parts: slots.length }, []]);
      const steps = answers.map(({ result }) => stepOf(result as Float64Array));
      const { tasks, isRefinement, best } = steps[0] as Step;
      // What was taken in the last step was all, or there is nothing that could be shared.
      if (tasks === 0) {
        if (found !== undefined) call.progress.report("refine", done, best);
        break;
      }
      found = interleaved(steps);
      const stage = isRefinement ? "refine" : "search";
      ms[stage] += performance.now() - start;
      call.progress.report(stage, done, best);
    }
    if (found === undefined) return await dropped(slots);
    const finish = { type: "finish", wantsProgress: call.progress.isWanted } as const;
    const { result } = await fromHolder(leader, holders[0]).request(finish, [], call.progress);
    await dropped(slots.slice(1));
    return withTimes(result as Alignment, ms);
  } catch (error) {
    if (![JobFailed, WorkerLost, Unsendable].some((kind) => error instanceof kind)) throw error;
    await dropped(slots);
    return null;
  }
}

/** Asks all at once, and waits for all: also for the others' answers where one fails. */
async function every(slots: readonly WorkerSlot[], request: (part: number) => [ShareRequest, ArrayBuffer[]]) {
  const answers = await Promise.allSettled(slots.map((slot, part) => slot.request(...request(part))));
  return answers.map((answer) => {
    if (answer.status === "rejected") throw answer.reason;
    return answer.value;
  });
}

/** The slot, as long as the worker that holds a share is in it: one that is lost between two rounds fails no request. */
function fromHolder(slot: WorkerSlot, holder: unknown): WorkerSlot {
  if (slot.worker !== holder) throw new WorkerLost("it held a share of a search");
  return slot;
}

/** Has the shares forgotten, as far as there are any. */
async function dropped(slots: readonly WorkerSlot[]): Promise<null> {
  const nothing = { type: "step", found: undefined, part: 0, parts: 0 } as const;
  await Promise.allSettled(slots.map((slot) => slot.request(nothing)));
  return null;
}

/** What came of a step. */
interface Step {
  /** Tasks of the round, all parts together; 0 when there is nothing left to do. */
  tasks: number;
  isRefinement: boolean;
  /** In how many numbers a task's outcome is told. */
  size: number;
  /** The best pose of the rounds before, and its score, once there is one. */
  best: Float64Array | undefined;
  /** What came of the part's tasks, and what else its worker found. */
  found: Float64Array;
}

function stepOf(numbers: Float64Array): Step {
  const [tasks = 0, isRefinement = 0, size = 0] = numbers;
  const best = numbers.slice(3, 20);
  // The matrix's last number is 1, except where there is none.
  const isThere = best[15] === 1;
  return {
    tasks,
    isRefinement: isRefinement === 1,
    size,
    best: isThere ? best : undefined,
    found: numbers.subarray(20),
  };
}

/** What came of all tasks, in their order, each of n parts having every n-th; then what else was found. */
function interleaved(steps: readonly Step[]): Float64Array {
  const all = new Float64Array(steps.reduce((sum, { found }) => sum + found.length, 0));
  const parts = steps.length;
  let end = 0;
  for (const [part, { tasks, size, found }] of steps.entries()) {
    const own = Math.ceil((tasks - part) / parts);
    for (let i = 0; i < own; i++) all.set(found.subarray(i * size, (i + 1) * size), (part + i * parts) * size);
    end = Math.max(end, tasks * size);
    all.set(found.subarray(own * size), end);
    end += found.length - own * size;
  }
  return all;
}

/** The stages that the leader alone did not see, in their place. */
function withTimes(alignment: Alignment, ms: Readonly<Record<"prepare" | "search" | "refine", number>>): Alignment {
  const { observe, sample, normals, metrics, ...others } = alignment.timingsMs;
  const stages = { observe, sample, normals, ...ms, metrics };
  const total = Object.values(stages).reduce((sum: number, stage) => sum + (stage ?? 0), 0);
  return { ...alignment, timingsMs: { ...stages, ...others, total } as Alignment["timingsMs"] };
}
