/**
 * `npm run profile -- [--runs N] [--quality NAME,…] [CASE…]`: the time of each stage natively (of the CPU) and in
 * WebAssembly (Node), in one run, and whether both give the same bits; what the stages draw, beside the least that arithmetic
 * would take; of a folder with frames, the time of a tracked frame in WebAssembly. Without a case, the sample, and a generated
 * video; in all qualities, where none is named.
 */
import { readdirSync } from "node:fs";
import { basename, resolve } from "node:path";
import { parseArgs } from "node:util";
import { compiledModule, qualities } from "./bench/inputs.mjs";
import { median } from "./bench/table.mjs";
import { profileVideo, readVideo, turningRing } from "./bench/videos.mjs";
import { runLab } from "./lib/lab.mjs";
import { sampleDir } from "./lib/paths.mjs";
import { copySample } from "./lib/sample.mjs";
import { script } from "./lib/step.mjs";

/** @typedef {{ matrix: number[], diagnostics: { timingsMs: Record<string, number> } }} Result */
/** @typedef {{ poses: number, vertices: number, triangles: number, filled: number, visited: number, cells: number }} Drawn */
/** @typedef {Result & { drawn: Record<string, Drawn> }} NativeResult with what each stage draws */

/**
 * Operations of a render on numbers, without loads and stores: transform, projection and rounding of a vertex; area of a
 * triangle, by which lines are left out; box, slopes and edges of one that is filled; depth, three edges, comparison
 * and selection of a cell; clearing a cell, and comparing it with the image.
 */
const OPERATIONS = { vertices: 37, triangles: 8, filled: 40, visited: 13, cells: 2 };
/** Numbers that one instruction takes at once. */
const LANES = 4;
/** Instructions of that kind in a nanosecond, of a core with 3 GHz that begins one in each cycle. */
const PER_NANOSECOND = 3;

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
 * @returns {Promise<NativeResult[]>}
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
  const [{ createAligner }, { readCaseFolder }] = await Promise.all(["index.js", "case-folder.js"].map(compiledModule));
  const aligner = await createAligner();
  const { input } = await readCaseFolder(folder);
  const results = [];
  for (let i = 0; i < runs; i++) results.push(await aligner.align(input, { quality }));
  return results;
}

/**
 * Prints what each stage draws: counts, and native CPU time per pose, triangle and visited cell beside the least time of a
 * pose. The time is that of the whole stage, scores and quadratics included.
 * @param {NativeResult} result
 * @param {Map<string, number>} milliseconds
 */
function printDrawn({ drawn }, milliseconds) {
  const heads = ["poses", "triangles", "filled", "cells", "ns/triangle", "ns/cell", "ns/pose", "least", "times"];
  console.log("drawn".padEnd(10) + heads.map((head) => head.padStart(12)).join(""));
  for (const [stage, counts] of Object.entries(drawn)) {
    if (counts.poses === 0) continue;
    const ns = 1e6 * (milliseconds.get(stage) ?? Number.NaN);
    const operations = Object.entries(OPERATIONS).reduce(
      (sum, [name, each]) => sum + each * counts[/** @type {keyof Drawn} */ (name)],
      0,
    );
    const least = operations / LANES / PER_NANOSECOND / counts.poses;
    const perPose = [counts.triangles, counts.filled, counts.visited].map((count) => count / counts.poses);
    const rates = [counts.triangles, counts.visited, counts.poses].map((count) => ns / count);
    const cells = [counts.poses, ...perPose, ...rates, least].map((x) => x.toFixed(x < 100 ? 1 : 0).padStart(12));
    console.log(stage.padEnd(10) + cells.join("") + (ns / counts.poses / least).toFixed(1).padStart(12));
  }
}

/**
 * Prints the tables of one case and quality.
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
  if (there[0] !== undefined) printDrawn(there[0], nativeMs);
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
