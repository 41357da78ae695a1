/**
 * `npm run soak -- [--count N] [--seed N]`: alignments of mixed inputs through a pool, with workers killed, calls aborted
 * and bad inputs between. Prints the memory by calls settled, and what became of them; fails if a call does not settle, if
 * bits differ from those of the input alone, or if the memory grows.
 */
import { join } from "node:path";
import { parseArgs } from "node:util";
import { buildPackage } from "./lib/package.mjs";
import { installDir } from "./lib/paths.mjs";
import { run } from "./lib/run.mjs";
import { script } from "./lib/step.mjs";
import { install, testEnvironment } from "./suites/installed.mjs";

await script(async () => {
  const { values } = parseArgs({ options: { count: { type: "string" }, seed: { type: "string" } } });
  await buildPackage();
  await install();
  const program = join(installDir, "tests", "support", "soak.js");
  const args = ["--expose-gc", "--enable-source-maps", program, values.count ?? "10000", values.seed ?? "1"];
  await run(process.execPath, args, { cwd: installDir, echo: true, patient: true, env: testEnvironment });
});
