// Waits until the queue is empty and writes a line of JSON for each result and each failure: node collect.mjs > results.jsonl
import { setTimeout as pause } from "node:timers/promises";
import { Queue } from "bullmq";
import { connect, queueName, report, resultsKey } from "./queue.mjs";

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
for await (const page of connection.hscanStream(resultsKey, { count: 500 })) {
  for (let i = 0; i < page.length; i += 2) {
    // Redis may name an entry twice.
    if (seen.has(page[i])) continue;
    seen.add(page[i]);
    console.log(JSON.stringify({ id: page[i], ...JSON.parse(page[i + 1]) }));
  }
}
const PAGE = 500;
for (let start = 0; ; start += PAGE) {
  const failed = await queue.getFailed(start, start + PAGE - 1);
  for (const { id, data, failedReason: error, attemptsMade: attempts } of failed) {
    console.log(JSON.stringify({ id, folder: data.folder, error, attempts }));
  }
  if (failed.length < PAGE) break;
}
await queue.close();
connection.disconnect();
