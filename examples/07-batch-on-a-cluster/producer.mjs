// Adds folders to the queue: node producer.mjs [--options JSON] [--list FILE] FOLDER...
import { createReadStream } from "node:fs";
import { resolve } from "node:path";
import { createInterface } from "node:readline";
import { parseArgs } from "node:util";
import { Queue } from "bullmq";
import { connect, inputsIn, jobIdOf, kindOf, queueName, report, requestOf, requestsKey } from "./queue.mjs";

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: { options: { type: "string", default: "{}" }, list: { type: "string" } },
});
const options = JSON.parse(values.options);

/** The folders of the command line, then those of the list, a path per line; "-" is stdin. */
async function* folders() {
  yield* positionals;
  if (values.list === undefined) return;
  const input = values.list === "-" ? process.stdin : createReadStream(values.list);
  for await (const line of createInterface({ input })) if (line !== "") yield line;
}

const connection = connect();
const queue = new Queue(queueName, { connection });
queue.on("error", report);
for await (const name of folders()) {
  const folder = resolve(name);
  const names = await inputsIn(folder);
  const jobId = await jobIdOf(folder, names, options);
  await connection.hset(requestsKey, requestOf(folder, options), jobId);
  // BullMQ does not add a job whose id already exists, whether it is waiting, completed or failed: a failed one is removed.
  if ((await queue.getJobState(jobId)) === "failed") await queue.remove(jobId);
  const retries = { attempts: 5, backoff: { type: "exponential", delay: 1000 } };
  await queue.add(kindOf(names), { folder, options }, { jobId, ...retries });
  console.log(jobId, folder);
}
await queue.close();
connection.disconnect();
