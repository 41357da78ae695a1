/** The lab's program: generated cases, baselines and measurements, native. */
import { once } from "./cache.mjs";
import { at } from "./paths.mjs";
import { run } from "./run.mjs";
import { rustToolchain } from "./setup.mjs";

/** Builds the program, optimised as the WebAssembly is. */
export const buildLab = once(async () => {
  await rustToolchain();
  await run("cargo", ["build", "--quiet", "--profile", "native", "--package", "sim3align-lab"]);
});

/**
 * @param {readonly string[]} args a subcommand and its arguments
 * @param {import("./run.mjs").RunOptions} [options]
 */
export async function runLab(args, options) {
  await buildLab();
  return run(at("target", "native", "sim3align-lab"), args, options);
}

/**
 * The same in the profile of the tests: optimised, and with checks of overflow. It is the program that the tests of the lab run:
 * to build it by itself would compile everything again, with other features of the dependencies.
 */
const buildTestedLab = once(async () => {
  await rustToolchain();
  await run("cargo", ["test", "--quiet", "--workspace", "--tests", "--no-run"]);
});

/**
 * @param {readonly string[]} args
 * @param {import("./run.mjs").RunOptions} [options]
 */
export async function runTestedLab(args, options) {
  await buildTestedLab();
  return run(at("target", "debug", "sim3align-lab"), args, options);
}
