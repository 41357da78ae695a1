/** The Rust tests, natively and as WebAssembly in Node. */
import { rustCounts, withStatus } from "../lib/counts.mjs";
import { print } from "../lib/output.mjs";
import { at } from "../lib/paths.mjs";
import { attempt } from "../lib/run.mjs";
import { rustToolchain, wasmBindgen, wasmTarget } from "../lib/setup.mjs";

/**
 * Runs tests; once more if they hang, because Node itself may: its end can deadlock (nodejs/node#54918).
 * @param {readonly string[]} args
 * @param {import("../lib/run.mjs").RunOptions} [options]
 */
async function cargoTest(args, options = {}) {
  const test = () => attempt("cargo", ["test", "--no-fail-fast", ...args], { echo: true, ...options });
  const first = await test();
  const { output, reason } = first.hung ? await test() : first;
  if (first.hung) print(`\ncargo test, at first: ${first.reason}.\n`);
  if (reason !== "") print(`cargo test: ${reason}\n`);
  return withStatus(rustCounts(output), reason === "");
}

/** With the features of the whole workspace, so that each dependency is compiled once; only WebAssembly runs the tests of physics. */
export async function native() {
  await rustToolchain();
  const programs = ["suite", "fuzz", "lab"].flatMap((name) => ["--test", name]);
  return cargoTest(["--workspace", "--exclude", "sim3align-physics", ...programs]);
}

export async function wasm() {
  await wasmBindgen();
  const packages = ["sim3align", "sim3align-physics"].flatMap((name) => ["--package", name]);
  return cargoTest(["--target", wasmTarget, ...packages, "--test", "suite"], {
    env: {
      CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUNNER: `${process.execPath} ${at("scripts", "lib", "wasm-tests.mjs")}`,
    },
  });
}
