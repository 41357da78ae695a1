// Waits until the queue is empty and writes a line of JSON for each folder: its result, or its failure: node collect.mjs > results.jsonl
import { setTimeout as pause } from "node:timers/promises";
import { Queue } from "bullmq";
import { connect, queueName, report, requestsKey, resultsKey } from "./queue.mjs";

const connection = connect();
const queue = new Queue(queueName, { connection });
queue.on("error", report);
for (;;) {
  const counts = await queue.getJobCounts("waiting", "active", "delayed", "prioritized", "completed", "failed");
  console.error(JSON.stringify(counts));
  const { completed, failed, ...open } = counts;
  if (Object.values(open).every((count) => count === 0)) break;
  await pause(500);
}
// Page by page: a million results are larger than a string can be.
const seen = new Set();
for await (const page of connection.hscanStream(requestsKey, { count: 500 })) {
  for (let i = 0; i < page.length; i += 2) {
    const [request, id] = [page[i], page[i + 1]];
    // Redis may name an entry twice.
    if (seen.has(request)) continue;
    seen.add(request);
    const [folder] = JSON.parse(request);
    const result = await connection.hget(resultsKey, id);
    console.log(JSON.stringify({ id, folder, ...(result === null ? await failureOf(id) : JSON.parse(result)) }));
  }
}
await queue.close();
connection.disconnect();

/** Why there is no result. A producer that was killed may have left a request without a job. @param {string} id */
async function failureOf(id) {
  const job = await queue.getJob(id);
  return { error: job?.failedReason ?? "not in the queue: call producer.mjs again", attempts: job?.attemptsMade ?? 0 };
}
