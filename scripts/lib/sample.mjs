/** The sample cases: seeded, made by the crate's own generator. */
import { cpSync, rmSync } from "node:fs";
import { join } from "node:path";
import { at } from "./paths.mjs";
import { run } from "./run.mjs";
import { step } from "./step.mjs";

/** The samples' case folders. */
export const samplesDir = at("target", "samples");
/** The one that the tests and the examples use. */
export const sampleDir = join(samplesDir, "mug");

/** Makes the sample, and gives the examples a copy. */
export async function makeSample() {
  await step("sample case", async (say) => {
    rmSync(sampleDir, { recursive: true, force: true });
    const generator = ["run", "--quiet", "--features", "samples", "--bin", "sim3align-samples", "--"];
    await run("cargo", [...generator, sampleDir, "--kind", "mug", "--seed", "1"]);
    cpSync(sampleDir, at("examples", "sample", "mug"), { recursive: true });
    say("target/samples/mug");
  });
}
