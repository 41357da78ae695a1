/** The Rust tests, natively and as WebAssembly in Node, and the samples that the crates' generator makes. */
import { readFileSync } from "node:fs";
import { relative } from "node:path";
import { filesBelow } from "../lib/cache.mjs";
import { rustCounts, withStatus } from "../lib/counts.mjs";
import { at } from "../lib/paths.mjs";
import { attempt } from "../lib/run.mjs";
import { generateSamples, pageSamplesDir } from "../lib/sample.mjs";
import { rustToolchain, wasmBindgen, wasmBindgenProgram, wasmTarget } from "../lib/setup.mjs";
import { runChecks } from "../lib/step.mjs";

/**
 * @param {readonly string[]} args
 * @param {NodeJS.ProcessEnv} [env]
 */
async function cargoTest(args, env = {}) {
  const { output, reason } = await attempt("cargo", ["test", "--no-fail-fast", ...args], { echo: true, env });
  return withStatus(rustCounts(output), reason === "");
}

export async function native() {
  await rustToolchain();
  return cargoTest(["--workspace"]);
}

export async function wasm() {
  await wasmBindgen();
  return cargoTest(
    ["--target", wasmTarget, "--package", "sim3align", "--package", "sim3align-physics", "--test", "suite"],
    {
      CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUNNER: wasmBindgenProgram("wasm-bindgen-test-runner"),
    },
  );
}

/** The generator writes the committed samples, byte by byte. */
export async function samples() {
  await rustToolchain();
  const folder = at("target", "samples", "page");
  return runChecks([
    [
      "www/samples",
      async (say) => {
        await generateSamples(folder);
        const [made, committed] = [folder, pageSamplesDir].map(
          (root) => new Map(filesBelow([root]).map((file) => [relative(root, file), readFileSync(file, "base64")])),
        );
        const names = [...new Set([...(made?.keys() ?? []), ...(committed?.keys() ?? [])])];
        const other = names.filter((name) => made?.get(name) !== committed?.get(name));
        if (other.length > 0) throw new Error(`Not reproduced: ${other.join(", ")}. Remedy: npm run samples.`);
        say(`${names.length} files`);
      },
    ],
  ]);
}
