/** The Rust tests, natively and as WebAssembly in Node. */
import { rustCounts, withStatus } from "../lib/counts.mjs";
import { attempt } from "../lib/run.mjs";
import { wasmBindgenProgram, wasmTarget } from "../lib/setup.mjs";

/**
 * @param {readonly string[]} args
 * @param {NodeJS.ProcessEnv} [env]
 */
async function cargoTest(args, env = {}) {
  const { output, reason } = await attempt("cargo", ["test", "--no-fail-fast", ...args], { echo: true, env });
  return withStatus(rustCounts(output), reason === "");
}

export const native = () => cargoTest(["--workspace"]);

export const wasm = () =>
  cargoTest(["--target", wasmTarget, "--package", "sim3align", "--test", "suite"], {
    CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUNNER: wasmBindgenProgram("wasm-bindgen-test-runner"),
  });
