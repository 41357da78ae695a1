/** The Rust tests, natively and as WebAssembly in Node. */
import { rustCounts, sum, withStatus } from "../lib/counts.mjs";
import { print } from "../lib/output.mjs";
import { attempt, run } from "../lib/run.mjs";
import { rustToolchain, wasmBindgen, wasmBindgenProgram, wasmTarget } from "../lib/setup.mjs";

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

/** Lets test programs of the stable compiler say how long each test takes, which is an unstable option of theirs. */
async function timing() {
  if (process.platform === "win32") return { env: {}, args: [] };
  const [, host = ""] = /^host: (.*)$/m.exec(await run("rustc", ["--version", "--verbose"])) ?? [];
  const runner = `CARGO_TARGET_${host.toUpperCase().replaceAll("-", "_")}_RUNNER`;
  return { env: { [runner]: "env RUSTC_BOOTSTRAP=1" }, args: ["--", "-Zunstable-options", "--report-time"] };
}

/** Of all packages at once, so that each dependency is compiled with the same features. */
export async function native() {
  await rustToolchain();
  const { env, args } = await timing();
  const programs = ["native", "fuzz", "lab"].flatMap((name) => ["--test", name]);
  const tests = await cargoTest(["--workspace", ...programs, ...args], { env });
  return sum([tests, await cargoTest(["--workspace", "--doc"])]);
}

export async function wasm() {
  await wasmBindgen();
  /** @type {import("../lib/counts.mjs").Timed[]} */
  const times = [];
  let last = performance.now();
  // The tests run one after the other, and each is told when it has ended.
  const onLine = (/** @type {string} */ line) => {
    const now = performance.now();
    const name = /^test (\S+) \.\.\. /.exec(line)?.[1];
    if (name !== undefined) times.push({ name, ms: now - last });
    last = now;
  };
  const packages = ["sim3align", "sim3align-physics"].flatMap((name) => ["--package", name]);
  const counts = await cargoTest(["--target", wasmTarget, ...packages, "--test", "suite"], {
    env: { CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUNNER: wasmBindgenProgram("wasm-bindgen-test-runner") },
    onLine,
  });
  return { ...counts, times };
}
