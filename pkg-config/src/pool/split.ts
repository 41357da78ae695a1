/**
 * One alignment, its search shared by several workers: each holds the input, does a part of every round's tasks, and is
 * told what came of all. The bits are those of an alignment by one (see `src/align/split.rs`).
 */
import type { Call } from "../engine.js";
import type { Job } from "../jobs.js";
import type { Alignment } from "../results.js";
import { buffersOf, copied } from "../transfer.js";
import type { ShareRequest, StepResult } from "./protocol.js";
import { JobFailed, WorkerLost, type WorkerSlot } from "./slot.js";

type AlignJob = Job & { method: "align" };

/** Progress when the rounds of the search are through. */
const ROUNDS = [0.35, 0.4, 0.55, 0.65, 0.72, 0.75];

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
    const prepared = performance.now();
    call.progress.report("search", 0.1);
    const ms = { prepare: prepared - began, search: 0, refine: 0 };
    let found: Float64Array | null = null;
    let hypothesis: Float64Array | null = null;
    for (let round = 0; ; round++) {
      const start = performance.now();
      const answers = await every(slots, (part) => [
        { type: "step", found, hypothesis, part, parts: slots.length },
        [],
      ]);
      const steps = answers.map(({ result }) => result as StepResult);
      const { tasks = 0, isRefinement = true } = steps[0] ?? {};
      if (tasks === 0 && round === 0) return await dropped(slots);
      if (tasks === 0) break;
      // Descriptors join the candidates of the grid, after the first of its rounds.
      hypothesis = round === 0 ? ((await leader.request({ type: "hypothesis" })).result as Float64Array) : null;
      found = interleaved(
        steps.map((step) => step.found),
        tasks,
      );
      ms[isRefinement ? "refine" : "search"] += performance.now() - start;
      call.progress.report(isRefinement ? "refine" : "search", ROUNDS[round] ?? 0.75);
    }
    const finish = { type: "finish", wantsProgress: call.progress.isWanted } as const;
    const { result } = await leader.request(finish, [], call.progress);
    await dropped(slots.slice(1));
    return withTimes(result as Alignment, ms);
  } catch (error) {
    if (!(error instanceof JobFailed || error instanceof WorkerLost) && !isCloneError(error)) throw error;
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

async function dropped(slots: readonly WorkerSlot[]): Promise<null> {
  await every(slots, () => [{ type: "drop" }, []]);
  return null;
}

const isCloneError = (error: unknown) => error instanceof Error && ["DataCloneError", "TypeError"].includes(error.name);

/** What came of all tasks, in their order: each of n parts has every n-th. */
function interleaved(parts: readonly Float64Array[], tasks: number): Float64Array {
  const all = new Float64Array(parts.reduce((sum, part) => sum + part.length, 0));
  const size = all.length / tasks;
  for (let task = 0; task < tasks; task++) {
    const begin = Math.floor(task / parts.length) * size;
    const part = parts[task % parts.length];
    if (part !== undefined) all.set(part.subarray(begin, begin + size), task * size);
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
