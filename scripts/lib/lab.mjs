/** The lab's program: generated cases and measurements, native. */
import { join } from "node:path";
import { digest, once } from "./cache.mjs";
import { at } from "./paths.mjs";
import { run } from "./run.mjs";
import { rustToolchain } from "./setup.mjs";

/**
 * `native` is as optimised as the WebAssembly. Tests take `dev`, in which they are compiled anyway; the bits are the same, and
 * overflow is checked.
 */
const profile = process.env.SIM3ALIGN_LAB_PROFILE ?? "native";

/** Builds the program. */
export const buildLab = once(async () => {
  await rustToolchain();
  // Of the whole workspace, with the features of which the tests compile the dependencies.
  await run("cargo", ["build", "--quiet", "--profile", profile, "--workspace", "--bin", "sim3align-lab"]);
});

/**
 * A digest of the sources of the program, and of other inputs of a result.
 * @param {readonly string[]} [inputs] paths
 * @param {readonly string[]} [facts]
 */
export function labCode(inputs = [], facts = []) {
  const sources = ["src", "geometry", "runtime", "formats", "lab", "Cargo.toml", "Cargo.lock"];
  return digest([...sources.map((path) => at(path)), ...inputs], facts);
}

/** Arguments that set the number of threads, as many as there are cores by default. @param {number} [threads] */
export const threadArguments = (threads) => (threads === undefined ? [] : ["--threads", `${threads}`]);

/**
 * @param {readonly string[]} args a subcommand and its arguments
 * @param {import("./run.mjs").RunOptions} [options]
 */
export async function runLab(args, options) {
  await buildLab();
  return run(join(at("target"), profile === "dev" ? "debug" : profile, "sim3align-lab"), args, options);
}
