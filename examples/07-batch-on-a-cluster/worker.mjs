// Does what is on the queue; as many of these on as many machines as you like: node worker.mjs
import { availableParallelism } from "node:os";
import { UnrecoverableError, Worker } from "bullmq";
import { createAligner, Sim3AlignError } from "sim3align";
import { connect, jobIdOf, queueName, readCase, resultsKey } from "./queue.mjs";

const threads = Number(process.env.THREADS ?? availableParallelism());
// How long a job may go without a sign of life before another worker takes it over. Alignments run in threads of their
// own: this one is free to give those signs, however long an alignment takes.
const lockDuration = Number(process.env.LOCK_MS ?? 30_000);
/** Faults of the surroundings: another attempt may succeed. All others are the input's, and stay. */
const passing = new Set(["WORKER_FAILED", "NOT_INITIALISED", "INTERNAL"]);

const connection = connect();
const aligner = await createAligner({ workers: threads });

const worker = new Worker(
  queueName,
  async ({ id = "", data: { folder, options } }) => {
    // Stored by a worker that died before it could say so.
    if (await connection.hexists(resultsKey, id)) return;
    const input = await readCase(folder);
    // The result would stand under the name of another case.
    if (jobIdOf(input, options) !== id) throw new UnrecoverableError("files or version have changed since");
    const { matrix, scale, confidence, alternatives, metrics, warnings } = await aligner
      .align(input, options)
      .catch((error) => {
        const isFinal = error instanceof Sim3AlignError && !passing.has(error.code);
        throw isFinal ? new UnrecoverableError(`${error.code}: ${error.message}`) : error;
      });
    const record = {
      folder,
      matrix,
      scale,
      confidence,
      alternatives: alternatives.length,
      metrics,
      warnings,
    };
    // The first one stays: should two have done the same job, their results are the same to the bit.
    const isFirst = await connection.hsetnx(resultsKey, id, JSON.stringify(record));
    if (isFirst) console.log("stored", id);
  },
  {
    connection,
    concurrency: threads,
    lockDuration,
    stalledInterval: lockDuration,
    // A job that was three times on a machine that went down may be what brings them down.
    maxStalledCount: 3,
  },
);
worker.on("active", ({ id }) => console.log("active", id));
worker.on("failed", (job, error) => console.log("failed", job?.id, error.message));
worker.on("error", (error) => console.error(error.message));

// Finishes what it has begun.
for (const signal of ["SIGTERM", "SIGINT"]) {
  process.once(signal, async () => {
    await worker.close();
    aligner.dispose();
    connection.disconnect();
  });
}
