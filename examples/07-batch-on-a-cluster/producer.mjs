// Adds cases to the queue: node producer.mjs [--options JSON] FOLDER...
import { resolve } from "node:path";
import { parseArgs } from "node:util";
import { Queue } from "bullmq";
import { connect, jobIdOf, queueName, readCase } from "./queue.mjs";

const { values, positionals: folders } = parseArgs({
  allowPositionals: true,
  options: { options: { type: "string", default: "{}" } },
});
const options = JSON.parse(values.options);
const connection = connect();
const queue = new Queue(queueName, { connection });
for (const folder of folders.map((name) => resolve(name))) {
  const jobId = jobIdOf(await readCase(folder), options);
  // BullMQ does not add a job whose id already exists, whether it is waiting, completed or failed.
  await queue.add("align", { folder, options }, { jobId, attempts: 5, backoff: { type: "exponential", delay: 1000 } });
  console.log(jobId, folder);
}
await queue.close();
connection.disconnect();
