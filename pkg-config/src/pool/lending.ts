/** Lends idle workers of a pool to long jobs of others. */
import { type Job, meshCacheOf } from "../jobs.js";
import type { CoreMesh } from "../prepared-mesh.js";
import { ProgressListener } from "../progress.js";
import type { Queue } from "../queue.js";
import type { WorkerSlot } from "./slot.js";
import { copied } from "./transfer.js";

/** A running job that has asked for help. */
interface Borrower {
  job: Job;
  /** The workers that help it, and those that are about to. */
  helpers: Set<WorkerSlot>;
  /** Number of helpers that it has had. */
  count: number;
  /** Whether it gets others. */
  mayBorrow: boolean;
}

/** Lends workers that have nothing to do, until a job waits for them. What they do changes no result. */
export class Lending {
  readonly #queue: Queue<WorkerSlot>;
  /** By the worker that runs the job. */
  readonly #borrowers = new Map<WorkerSlot, Borrower>();

  constructor(queue: Queue<WorkerSlot>) {
    this.#queue = queue;
  }

  /** The job that this worker runs is long. */
  ask(slot: WorkerSlot, job: Job): void {
    this.#borrowers.set(slot, { job, helpers: new Set(), count: 0, mayBorrow: true });
    this.lend();
  }

  /** The job that this worker ran has ended. */
  end(slot: WorkerSlot): void {
    const borrower = this.#borrowers.get(slot);
    this.#borrowers.delete(slot);
    for (const helper of borrower?.helpers ?? []) helper.tell({ type: "stop-helping" });
  }

  /** Lends the workers that are idle, each to the job with the fewest helpers. */
  lend(): void {
    for (;;) {
      const [slot, borrower] = this.#inOrder().find(([, { mayBorrow }]) => mayBorrow) ?? [];
      const helper = slot && this.#queue.takeIdle();
      if (slot === undefined || borrower === undefined || helper === undefined) return;
      borrower.helpers.add(helper);
      this.#help(slot, borrower, helper);
    }
  }

  /** Calls a worker back for a job that waits, if none is idle. */
  recall(): void {
    if (this.#queue.hasIdle) return;
    const helpers = this.#inOrder().at(-1)?.[1].helpers;
    for (const helper of helpers ?? []) {
      helpers?.delete(helper);
      helper.tell({ type: "stop-helping" });
      return;
    }
  }

  async #help(slot: WorkerSlot, borrower: Borrower, helper: WorkerSlot): Promise<void> {
    const isRunning = () => this.#borrowers.get(slot) === borrower;
    let place: number | undefined;
    try {
      await helper.ready();
      // While it started, it may have been called back.
      if (!borrower.helpers.has(helper)) return;
      const { port1, port2 } = new MessageChannel();
      const mesh = preparedMesh(borrower.job);
      const isKnown = mesh === undefined || helper.hasMesh(mesh.id, mesh.cache);
      slot.tell({ type: "helper", port: port1 }, [port1]);
      place = borrower.count++;
      const request = { type: "help", port: port2, mesh: isKnown ? undefined : copied(mesh.arrays) } as const;
      await helper.request(request, [port2], { progress: new ProgressListener(undefined) }, mesh);
    } catch {
      // The job does without helpers: what is wrong, if anything, it will find itself.
      borrower.mayBorrow = false;
    } finally {
      borrower.helpers.delete(helper);
      if (isRunning() && place !== undefined) slot.tell({ type: "helper-left", helper: place });
      this.#queue.release(helper);
      this.lend();
    }
  }

  /** Those with the fewest helpers first. */
  #inOrder(): [WorkerSlot, Borrower][] {
    return [...this.#borrowers].sort(([, a], [, b]) => a.helpers.size - b.helpers.size);
  }
}

/** The prepared mesh of a job. */
function preparedMesh(job: Job) {
  if (!("meshId" in job) || job.meshId === undefined) return undefined;
  const { warnings: _, ...arrays } = (job.data as { mesh: CoreMesh & { warnings?: unknown } }).mesh;
  return { id: job.meshId, cache: meshCacheOf(job), arrays };
}
