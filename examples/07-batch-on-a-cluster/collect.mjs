// Waits until the queue is empty and writes results and failures as JSON: node collect.mjs > results.json
import { setTimeout as pause } from "node:timers/promises";
import { Queue } from "bullmq";
import { connect, queueName, resultsKey } from "./queue.mjs";

const connection = connect();
const queue = new Queue(queueName, { connection });
for (;;) {
  const counts = await queue.getJobCounts("waiting", "active", "delayed", "prioritized", "completed", "failed");
  console.error(JSON.stringify(counts));
  const { completed, failed, ...open } = counts;
  if (Object.values(open).every((count) => count === 0)) break;
  await pause(500);
}
const stored = await connection.hgetall(resultsKey);
const results = Object.entries(stored).map(([id, json]) => ({ id, ...JSON.parse(json) }));
const failures = (await queue.getFailed()).map(({ id, data, failedReason, attemptsMade }) => ({
  ...{ id, folder: data.folder, reason: failedReason, attempts: attemptsMade },
}));
console.log(JSON.stringify({ results, failures }, null, 2));
await queue.close();
connection.disconnect();
