/** The sample case: seeded, made by the crate's own generator. */
import { cpSync, rmSync } from "node:fs";
import { at } from "./paths.mjs";
import { run } from "./run.mjs";
import { step } from "./step.mjs";

/** The sample's case folder. */
export const sampleDir = at("target", "samples", "mug");

/** Makes the sample, and gives the page and the examples a copy each. */
export async function makeSample() {
  await step("sample case", async (say) => {
    rmSync(sampleDir, { recursive: true, force: true });
    const generator = ["run", "--quiet", "--features", "samples", "--bin", "sim3align-samples", "--"];
    await run("cargo", [...generator, sampleDir, "--kind", "mug", "--seed", "1"]);
    cpSync(sampleDir, at("www", "samples", "mug"), { recursive: true });
    cpSync(sampleDir, at("examples", "sample", "mug"), { recursive: true });
    say("target/samples/mug");
  });
}
