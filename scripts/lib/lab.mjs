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
