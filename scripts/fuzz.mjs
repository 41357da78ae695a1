/**
 * `npm run fuzz -- [--minutes N] [--seed N] [--only NAME,…]`: searches for inputs on which the package fails. The fuzzers
 * share the minutes. The command fails if one of them finds something.
 */
import { join } from "node:path";
import { parseArgs } from "node:util";
import { runTestedLab } from "./lib/lab.mjs";
import { buildPackage } from "./lib/package.mjs";
import { installDir } from "./lib/paths.mjs";
import { run } from "./lib/run.mjs";
import { explain, script } from "./lib/step.mjs";
import { install, testEnvironment } from "./suites/installed.mjs";

/**
 * Each prints what it tried and throws for a finding; a different seed tries different inputs.
 * @type {Record<string, { title: string, search: (minutes: string, seed: string) => Promise<unknown> }>}
 */
const fuzzers = {
  javascript: {
    title: "Arguments and pools of the package",
    async search(minutes, seed) {
      await buildPackage();
      await install();
      const program = join(installDir, "tests", "support", "fuzz", "program.js");
      const remedy = "mend what the seeds show, and keep each as a test of its own";
      const args = ["--enable-source-maps", program, minutes, seed];
      await run(process.execPath, args, { cwd: installDir, echo: true, patient: true, env: testEnvironment, remedy });
    },
  },
  core: {
    title: "Readers, align, views, trackers, evaluate and register, native",
    async search(minutes, seed) {
      const remedy = "mend what the choices in lab/findings show, and keep them in lab/regressions";
      await runTestedLab(["fuzz", "--minutes", minutes, "--seed", seed], { echo: true, remedy });
    },
  },
};

await script(async () => {
  const { values } = parseArgs({
    options: {
      minutes: { type: "string", default: "10" },
      seed: { type: "string", default: "0" },
      only: { type: "string", default: Object.keys(fuzzers).join() },
    },
  });
  const names = values.only.split(",");
  const chosen = names.flatMap((name) => fuzzers[name] ?? []);
  if (chosen.length < names.length) {
    throw new Error(`--only: found ${names.join()}, expected some of ${Object.keys(fuzzers).join()}.`);
  }
  const minutes = Number(values.minutes) / chosen.length;
  for (const { title, search } of chosen) {
    console.log(`\n${title}: ${minutes.toFixed(1)} minutes`);
    // The others still run.
    await search(`${minutes}`, `${Number(values.seed)}`).catch((error) => {
      explain(error);
      process.exitCode = 1;
    });
  }
});
