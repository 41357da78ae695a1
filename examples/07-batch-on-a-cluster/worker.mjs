// Processes the queue. Run any number of these, on any number of machines: node worker.mjs
import { availableParallelism } from "node:os";
import { UnrecoverableError, Worker } from "bullmq";
import { createAligner } from "sim3align";
import { connect, inputsIn, jobIdOf, kindOf, queueName, report, resultsKey } from "./queue.mjs";
import { isOfInput, perform } from "./work.mjs";

const threads = Number(process.env.THREADS ?? availableParallelism());
// After this time without renewal of its lock, a job is taken over by another worker. Alignments run in their own threads,
// so this thread can renew the locks however long an alignment takes.
const lockDuration = Number(process.env.LOCK_MS ?? 30_000);

const connection = connect();
const aligner = await createAligner({ workers: threads });

const worker = new Worker(
  queueName,
  async ({ id = "", data: { folder, options } }) => {
    // A worker stored the result and was killed before it completed the job.
    if (await connection.hexists(resultsKey, id)) return "was stored";
    const names = await inputsIn(folder);
    // If the files have changed since, the id would belong to another case.
    if ((await jobIdOf(folder, names, options)) !== id) {
      throw new UnrecoverableError("files or version have changed since");
    }
    const kind = kindOf(names);
    const result = await perform[kind](aligner, { path: folder, names }, options).catch((error) => {
      throw isOfInput(error) ? new UnrecoverableError(`${error.code}: ${error.message}`) : error;
    });
    // Keep the first result: if two workers did the same job, their results are bit-identical.
    const isFirst = await connection.hsetnx(resultsKey, id, JSON.stringify({ kind, ...result }));
    if (isFirst) console.log("stored", id);
    return "done";
  },
  {
    connection,
    concurrency: threads,
    lockDuration,
    stalledInterval: lockDuration,
    // A job whose worker was killed three times may be the cause.
    maxStalledCount: 3,
  },
);
worker.on("active", ({ id }) => console.log("active", id));
worker.on("failed", (job, error) => console.log("failed", job?.id, error.message));
worker.on("error", report);

// On shutdown, finishes the running jobs.
for (const signal of ["SIGTERM", "SIGINT"]) {
  process.once(signal, async () => {
    await worker.close();
    aligner.dispose();
    connection.disconnect();
  });
}
