/**
 * `npm run fuzz -- [--minutes N] [--seed N]`: calls with hostile inputs, natively and through the package, with one seed after
 * the other. Ends at the first fault, with its seed.
 */
import { join } from "node:path";
import { parseArgs } from "node:util";
import { installDir } from "./lib/paths.mjs";
import { run } from "./lib/run.mjs";
import { rustToolchain } from "./lib/setup.mjs";
import { script, step } from "./lib/step.mjs";
import { install, testEnvironment } from "./suites/installed.mjs";

await script(async () => {
  const { values } = parseArgs({
    options: { minutes: { type: "string", default: "10" }, seed: { type: "string", default: "1" } },
  });
  await rustToolchain();
  await install();
  const test = join(installDir, "tests", "js", "fuzz.test.js");
  const began = performance.now();
  for (let seed = Number(values.seed); performance.now() - began < 60_000 * Number(values.minutes); seed++) {
    const env = { ...testEnvironment, SIM3ALIGN_FUZZ_SEED: `${seed}` };
    const remedy = "correct it, and keep the input as a test";
    await step(`seed ${seed}`, async () => {
      await run("cargo", ["test", "--quiet", "--test", "fuzz"], { env, remedy });
      await run(process.execPath, ["--test", test], { cwd: installDir, env, remedy });
    });
  }
});
