/** The Rust tests, natively and as WebAssembly in Node, and the samples that the crates' generator makes. */
import { readFileSync } from "node:fs";
import { relative } from "node:path";
import { cached, digest, filesBelow } from "../lib/cache.mjs";
import { rustCounts, sum, withStatus } from "../lib/counts.mjs";
import { print } from "../lib/output.mjs";
import { at } from "../lib/paths.mjs";
import { attempt, run } from "../lib/run.mjs";
import { generateSamples, pageSamplesDir } from "../lib/sample.mjs";
import { rustToolchain, wasmBindgen, wasmBindgenProgram, wasmTarget } from "../lib/setup.mjs";
import { runChecks } from "../lib/step.mjs";

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

export async function native() {
  await rustToolchain();
  const { env, args } = await timing();
  const tests = await cargoTest(["--workspace", "--tests", ...args], { env });
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

/** The generator writes the committed samples, byte by byte. */
export const samples = () =>
  runChecks([
    [
      "www/samples",
      async (say) => {
        const sources = ["src", "geometry", "formats", "lab", "Cargo.toml", "Cargo.lock", "scripts/lib"].map((path) =>
          at(path),
        );
        const stamp = at("target", "samples", "reproduced-from");
        const isNew = await cached(stamp, digest([...sources, pageSamplesDir]), [], reproduceSamples);
        say(`${filesBelow([pageSamplesDir]).length} files${isNew ? "" : ", up to date"}`);
      },
    ],
  ]);

async function reproduceSamples() {
  const folder = at("target", "samples", "page");
  await generateSamples(folder);
  const [made = new Map(), committed = new Map()] = [folder, pageSamplesDir].map(
    (root) => new Map(filesBelow([root]).map((file) => [relative(root, file), readFileSync(file, "base64")])),
  );
  const other = [...new Set([...made.keys(), ...committed.keys()])].filter(
    (name) => made.get(name) !== committed.get(name),
  );
  if (other.length > 0) throw new Error(`Not reproduced: ${other.join(", ")}. Remedy: npm run samples.`);
}
