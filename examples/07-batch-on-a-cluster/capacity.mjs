// Says what a large queue needs, from the jobs that were done: node capacity.mjs --jobs 1000000 --hours 24 [--price EACH_HOUR]
import { availableParallelism } from "node:os";
import { parseArgs } from "node:util";
import { Queue } from "bullmq";
import { connect, queueName, report, requestsKey, resultsKey } from "./queue.mjs";

const { values } = parseArgs({
  options: {
    jobs: { type: "string", default: "1000000" },
    hours: { type: "string", default: "24" },
    threads: { type: "string", default: process.env.THREADS ?? `${availableParallelism()}` },
    price: { type: "string" },
  },
});
const [jobs, hours, threads] = [values.jobs, values.hours, values.threads].map(Number);

const connection = connect();
const queue = new Queue(queueName, { connection });
queue.on("error", report);
// The last ones. What a worker found stored took no time.
const completed = await queue.getCompleted(0, 999);
const done = completed.filter(({ returnvalue }) => returnvalue === "done");
/** Bytes of Redis for a key and its value. */
const bytesOf = async (key) => Number(await connection.call("MEMORY", "USAGE", key, "SAMPLES", "100"));
// A result, a request, the job, and its place in the list of those that are completed.
const jobBytes = await Promise.all(done.slice(0, 100).map(({ id = "" }) => bytesOf(queue.toKey(id))));
const memory =
  (await bytesOf(resultsKey)) / (await connection.hlen(resultsKey)) +
  (await bytesOf(requestsKey)) / (await connection.hlen(requestsKey)) +
  jobBytes.reduce((a, b) => a + b, 0) / jobBytes.length +
  (await bytesOf(queue.toKey("completed"))) / (await queue.getCompletedCount());
await queue.close();
connection.disconnect();
if (done.length === 0) {
  console.error("No job is done. Queue a few hundred folders as they occur, and run one worker.");
  process.exit(1);
}

const seconds = done.map(({ processedOn = 0, finishedOn = 0 }) => (finishedOn - processedOn) / 1000);
const each = seconds.reduce((a, b) => a + b) / seconds.length;
const deviation = Math.sqrt(seconds.reduce((sum, x) => sum + (x - each) ** 2, 0) / Math.max(1, seconds.length - 1));
const needed = Math.ceil((jobs * each) / (3600 * hours));
const machines = Math.ceil(needed / threads);
const machineHours = (jobs * each) / (3600 * threads);
const lines = {
  measured: `${done.length} jobs`,
  "seconds of a thread per job": `${each.toFixed(2)} ± ${(deviation / Math.sqrt(done.length)).toFixed(2)}`,
  "jobs per hour and machine": `${Math.floor((3600 * threads) / each)} (${threads} threads)`,
  "machines, for the jobs in the time": `${machines} (${needed} threads for ${jobs} jobs in ${hours} h)`,
  "machine hours": machineHours.toFixed(1),
  ...(values.price === undefined ? {} : { cost: (machineHours * Number(values.price)).toFixed(2) }),
  "memory of Redis": `${((memory * jobs) / 2 ** 30).toFixed(1)} GB`,
};
for (const [name, value] of Object.entries(lines)) console.log(`${name.padEnd(36)}${value}`);
