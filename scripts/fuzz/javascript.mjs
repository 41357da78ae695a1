/** The fuzzer of the package, which `npm test` runs as well: odd arguments, and storms of a pool. */
import { join } from "node:path";
import { buildPackage } from "../lib/package.mjs";
import { installDir } from "../lib/paths.mjs";
import { run } from "../lib/run.mjs";
import { install, testEnvironment } from "../suites/installed.mjs";

/** @param {import("../fuzz.mjs").Budget} budget */
export async function fuzzJavaScript({ minutes, seed }) {
  await buildPackage();
  await install();
  const program = join(installDir, "tests", "support", "fuzz", "program.js");
  await run(process.execPath, ["--enable-source-maps", program, `${minutes}`, `${seed}`], {
    cwd: installDir,
    echo: true,
    env: testEnvironment,
    remedy: "mend what the seeds show, and keep each as a test of its own",
  });
}
