/** `npm run speed`: time and memory of this build; see `--help`. */
import { readdirSync } from "node:fs";
import { resolve } from "node:path";
import { command, count } from "./bench/command.mjs";
import { buildPackage } from "./lib/package.mjs";
import { sampleDir } from "./lib/paths.mjs";
import { copySample } from "./lib/sample.mjs";
import { caseFolders } from "./speed/inputs.mjs";
import { measurePool } from "./speed/pool.mjs";
import { measureSizes } from "./speed/sizes.mjs";
import { measureStages } from "./speed/stages.mjs";
import { measureVideo } from "./speed/video.mjs";

const parts = ["stages", "sizes", "video", "pool"];

/** @typedef {{ only: string[], runs: number, quality: string, quick: boolean }} Options */

/** @param {string[]} paths @param {Options} options */
async function measure(paths, options) {
  await buildPackage();
  await copySample();
  const unknown = options.only.filter((part) => !parts.includes(part));
  if (unknown.length > 0) throw new Error(`--only: found ${unknown.join(", ")}, expected some of ${parts.join(", ")}.`);
  const isVideo = (/** @type {string} */ path) => readdirSync(path).some((name) => name.startsWith("frame_"));
  const videos = paths.filter(isVideo).map((path) => resolve(path));
  const found = caseFolders(paths.filter((path) => !isVideo(path)));
  const cases = found.length > 0 ? found : [sampleDir];
  const run = options.quick ? { ...options, runs: 1 } : options;
  console.log(
    `Node ${process.version}, WebAssembly, one thread unless workers are named, medians of ${run.runs} runs.`,
  );
  if (run.only.includes("stages")) await measureStages(cases, run);
  if (run.only.includes("sizes")) await measureSizes(run);
  if (run.only.includes("video")) await measureVideo(videos, run);
  if (run.only.includes("pool")) await measurePool(found, run);
}

await command("speed", (program) =>
  program
    .description("Measures time and memory: stages of an alignment, sizes of inputs, a tracked frame, the pool.")
    .argument("[folder...]", "case folders, folders of case folders, and folders with frames; by default the sample")
    .option("--only <part...>", `some of ${parts.join(", ")}`, parts)
    .option("--runs <n>", "runs that count", count, 5)
    .option("--quality <name>", "of the stages", "auto")
    .option("--quick", "one run of the smallest inputs", false)
    .action(measure),
);
