/**
 * `npm run profile -- [--runs N] [--quality NAME,…] [CASE…]`: the time of each stage natively and in
 * WebAssembly (Node), in one run, and whether both give the same bits; of a folder with frames, the time of a tracked frame
 * in WebAssembly. Without a case, the sample, and a generated video; in all qualities, where none is named.
 */
import { readdirSync } from "node:fs";
import { basename, resolve } from "node:path";
import { parseArgs } from "node:util";
import { packageModule, qualities } from "./bench/inputs.mjs";
import { median } from "./bench/table.mjs";
import { profileVideo, readVideo, turningRing } from "./bench/videos.mjs";
import { runLab } from "./lib/lab.mjs";
import { sampleDir } from "./lib/paths.mjs";
import { copySample } from "./lib/sample.mjs";
import { script } from "./lib/step.mjs";

/** @typedef {{ matrix: number[], diagnostics: { timingsMs: Record<string, number> } }} Result */

/**
 * Median milliseconds by stage.
 * @param {readonly Result[]} results
 */
function medians(results) {
  const stages = Object.keys(results[0]?.diagnostics.timingsMs ?? {});
  return new Map(
    stages.map((stage) => [stage, median(results.map((result) => result.diagnostics.timingsMs[stage] ?? Number.NaN))]),
  );
}

/**
 * @param {string} folder
 * @param {string} quality
 * @param {number} runs
 * @returns {Promise<Result[]>}
 */
async function native(folder, quality, runs) {
  return JSON.parse(await runLab(["profile", "--quality", quality, `${runs}`, folder]))[folder];
}

/**
 * @param {string} folder
 * @param {string} quality
 * @param {number} runs
 * @returns {Promise<Result[]>}
 */
async function webAssembly(folder, quality, runs) {
  const [{ createAligner }, { readCaseFolder }] = await Promise.all(["index.js", "case-folder.js"].map(packageModule));
  const aligner = await createAligner();
  const { input } = await readCaseFolder(folder);
  const results = [];
  for (let i = 0; i < runs; i++) results.push(await aligner.align(input, { quality }));
  return results;
}

/**
 * Prints the table of one case and quality.
 * @param {string} folder
 * @param {string} quality
 * @param {number} runs
 */
async function profile(folder, quality, runs) {
  const [there, here] = [await native(folder, quality, runs), await webAssembly(folder, quality, runs)];
  const [nativeMs, wasmMs] = [medians(there), medians(here)];
  console.log(`\n${basename(folder)}, quality ${quality}, median of ${runs} runs`);
  console.log(`${"stage".padEnd(10)}${"native ms".padStart(12)}${"wasm ms".padStart(12)}${"ratio".padStart(8)}`);
  for (const [stage, ms] of wasmMs) {
    const other = nativeMs.get(stage) ?? Number.NaN;
    const cells = [other.toFixed(1).padStart(12), ms.toFixed(1).padStart(12), (ms / other).toFixed(2).padStart(8)];
    console.log(stage.padEnd(10) + cells.join(""));
  }
  const [a, b] = [there[0]?.matrix ?? [], here[0]?.matrix ?? []];
  const off = Math.max(...a.map((x, i) => Math.abs(x - (b[i] ?? Number.NaN))));
  console.log(off === 0 ? "The matrices are the same to the bit." : `The matrices differ by up to ${off}.`);
}

await script(async () => {
  const { values, positionals } = parseArgs({
    options: { runs: { type: "string" }, quality: { type: "string" } },
    allowPositionals: true,
  });
  const runs = Number(values.runs ?? 7);
  await copySample();
  const all = await qualities();
  const chosen = values.quality?.split(",") ?? all;
  const unknown = chosen.filter((quality) => !all.includes(quality));
  if (unknown.length > 0) throw new Error(`--quality: found ${unknown.join()}, expected ${all.join(", ")}.`);
  const folders = positionals.length > 0 ? positionals.map((folder) => resolve(folder)) : [sampleDir];
  for (const folder of folders.filter((candidate) => readdirSync(candidate).includes("camera.json"))) {
    for (const quality of chosen) await profile(folder, quality, runs);
  }
  const isVideo = (/** @type {string} */ folder) => readdirSync(folder).some((name) => name.startsWith("frame_"));
  for (const folder of folders.filter(isVideo)) await profileVideo(await readVideo(folder), runs);
  if (positionals.length === 0) await profileVideo(turningRing(60), runs);
});
