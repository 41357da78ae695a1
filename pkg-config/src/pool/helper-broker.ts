/** Lends idle workers of a pool to long jobs of others. */
import { type Job, moduleOf } from "../calls/calls.js";
import type { Queue } from "../concurrency/queue.js";
import type { CoreMesh } from "../values/prepared-mesh.js";
import { copied } from "../values/transfer.js";
import type { Slot, WorkerSetup } from "./pool-worker.js";

/** A running job that has asked for help. */
interface LongJob {
  job: Job;
  /** The workers that help it, and those that are about to. */
  helpers: Set<Slot>;
  /** Number of helpers that it has had. */
  count: number;
  /** Whether it gets others. */
  mayHaveHelp: boolean;
}

/** Lends workers that have nothing to do, until a job waits for them. What they do changes no result. */
export class HelperBroker {
  /** The long jobs, by the worker that runs each. */
  readonly #longJobs = new Map<Slot, LongJob>();

  constructor(
    private readonly queue: Queue<Slot>,
    private readonly compiled: WorkerSetup["compiled"],
  ) {}

  /** The job that this worker runs is long. */
  ask(slot: Slot, job: Job): void {
    this.#longJobs.set(slot, { job, helpers: new Set(), count: 0, mayHaveHelp: true });
    this.lend();
  }

  /** The job that this worker ran has ended. */
  end(slot: Slot): void {
    const longJob = this.#longJobs.get(slot);
    this.#longJobs.delete(slot);
    for (const helper of longJob?.helpers ?? []) helper.last.post({ type: "stop" });
  }

  /** Lends the workers that are idle, each to the job with the fewest helpers. */
  lend(): void {
    for (;;) {
      const [slot, longJob] = this.#inOrder().find(([, { mayHaveHelp }]) => mayHaveHelp) ?? [];
      const helper = slot && this.queue.takeIdle();
      if (slot === undefined || longJob === undefined || helper === undefined) return;
      longJob.helpers.add(helper);
      this.#help(slot, longJob, helper);
    }
  }

  /** Calls a worker back for a job that waits, if none is idle. */
  recall(): void {
    if (this.queue.hasIdle) return;
    const helpers = this.#inOrder().at(-1)?.[1].helpers;
    for (const helper of helpers ?? []) {
      helpers?.delete(helper);
      helper.last.post({ type: "stop" });
      return;
    }
  }

  async #help(slot: Slot, longJob: LongJob, helper: Slot): Promise<void> {
    const isRunning = () => this.#longJobs.get(slot) === longJob;
    // While it waited, it may have been called back, or the job may have ended.
    const isWanted = () => longJob.helpers.has(helper) && isRunning();
    let place: number | undefined;
    const { job } = longJob;
    const module = moduleOf(job.method);
    try {
      const modules = new Map([[module, await this.compiled(module)]]);
      // After the pool has ended, nothing would end a new worker.
      if (!isWanted()) return;
      await helper.ensureWorker().ready();
      if (!isWanted()) return;
      const { port1, port2 } = new MessageChannel();
      place = longJob.count++;
      slot.last.post({ type: "helper", helper: place, port: port1 }, [port1]);
      const cached = job.meshId === undefined ? undefined : { id: job.meshId, module };
      const mesh = cached === undefined || helper.last.hasMesh(cached) ? undefined : copied(preparedMesh(job));
      const help = { method: "help", data: { port: port2, mesh } } as const;
      const answer = await helper.last.request({ job: help, transfer: [port2], modules, mesh: cached });
      if (answer?.result === undefined) longJob.mayHaveHelp = false;
    } catch {
      // The job continues without helpers; it reports a fault itself, if there is one.
      longJob.mayHaveHelp = false;
    } finally {
      longJob.helpers.delete(helper);
      if (isRunning() && place !== undefined) slot.last.post({ type: "helper", helper: place });
      this.queue.release(helper);
      this.lend();
    }
  }

  /** The long jobs, those with the fewest helpers first. */
  #inOrder(): [Slot, LongJob][] {
    return [...this.#longJobs].sort(([, a], [, b]) => a.helpers.size - b.helpers.size);
  }
}

/** The arrays of the prepared mesh of a job. */
function preparedMesh({ data }: Job): CoreMesh {
  const { warnings: _, ...arrays } = (data as { mesh: CoreMesh & { warnings?: unknown } }).mesh;
  return arrays;
}
