/** `npm run bench:cases -- …`: `sim3align-bench`, as fast as it gets; `npm run bench:cases -- --help` tells its arguments. */
import { script } from "../lib/step.mjs";
import { runBenchmark } from "./records.mjs";

await script(() => runBenchmark(process.argv.slice(2), { attach: true }));
