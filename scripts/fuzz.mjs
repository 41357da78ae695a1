/**
 * `npm run fuzz -- [--minutes N] [--seed N] [--only NAME,…]`: searches for inputs on which the package fails. The fuzzers
 * share the minutes. The command fails if one of them finds something.
 */
import { parseArgs } from "node:util";
import { fuzzCore } from "./fuzz/core.mjs";
import { fuzzJavaScript } from "./fuzz/javascript.mjs";
import { explain, script } from "./lib/step.mjs";

/**
 * @typedef {object} Budget
 * @property {number} minutes of this fuzzer
 * @property {number} seed the first one; a different seed tries different inputs
 */

/**
 * Each prints what it tried and throws for a finding.
 * @type {Record<string, { title: string, run: (budget: Budget) => Promise<void> }>}
 */
const fuzzers = {
  javascript: { title: "Arguments and pools of the package", run: fuzzJavaScript },
  core: { title: "Readers, align, views, trackers, evaluate and register, native", run: fuzzCore },
};

await script(async () => {
  const { values } = parseArgs({
    options: { minutes: { type: "string" }, seed: { type: "string" }, only: { type: "string" } },
  });
  const names = values.only?.split(",") ?? Object.keys(fuzzers);
  const chosen = names.flatMap((name) => fuzzers[name] ?? []);
  if (chosen.length < names.length) {
    throw new Error(`--only: found ${names.join()}, expected some of ${Object.keys(fuzzers).join()}.`);
  }
  const minutes = Number(values.minutes ?? 10) / chosen.length;
  for (const { title, run } of chosen) {
    console.log(`\n${title}: ${minutes.toFixed(1)} minutes`);
    try {
      await run({ minutes, seed: Number(values.seed ?? 0) });
    } catch (error) {
      // The others still run.
      explain(error);
      process.exitCode = 1;
    }
  }
});
