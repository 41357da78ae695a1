/** Time and success of `align` as WebAssembly on one thread, alternating with FPFH, RANSAC and ICP of Open3D on all threads. */
import { readFileSync, rmSync } from "node:fs";
import { availableParallelism, loadavg } from "node:os";
import { join } from "node:path";
import { runPeers } from "../bench/peers.mjs";
import { fixed, markdownTable, median } from "../bench/table.mjs";
import { at } from "../lib/paths.mjs";
import { createAligner, readTypedCase } from "./inputs.mjs";

/** Open3D's tutorial; RANSAC that estimates the scale too; ICP on thinned clouds. */
const peers = ["open3d-ransac", "open3d-ransac-scale", "open3d-ransac-thinned"];

/**
 * @param {readonly string[]} folders
 * @param {{ runs: number, python: string }} options
 */
export async function measurePeers(folders, { runs, python }) {
  const aligner = await createAligner();
  const cases = await Promise.all(folders.map(readTypedCase));
  const out = at("target", "bench", "speed");
  const load = loadavg()[0];
  /** @type {{ name: string, method: string, ms: number, isRight: boolean | null }[]} */
  const found = [];
  const add = async (
    /** @type {typeof cases[number]} */ { name, input, truth },
    method = "",
    ms = 0,
    /** @type {any} */ pose,
  ) => {
    const options = truth && { truth: truth.matrix, symmetry: truth.symmetry };
    // No answer, or none that is a similarity, is wrong.
    const errors = options && pose && (await aligner.evaluate(input, pose, options).catch(() => ({}))).errors;
    const isWithin = errors && errors.scaleError <= 0.05 && errors.translationErrorRelative <= 0.05;
    found.push({ name, method, ms, isRight: truth && Boolean(isWithin && errors.rotationErrorDeg <= 10) });
  };
  // In the first round, caches and compilers warm up.
  for (let run = 0; run <= runs; run++) {
    for (const each of cases) {
      const began = performance.now();
      const pose = await aligner.align(each.input);
      if (run > 0) await add(each, "align", performance.now() - began, pose);
    }
    if (run === 0) continue;
    rmSync(out, { recursive: true, force: true });
    const answered = await runPeers({
      cases: folders,
      out,
      methods: peers,
      jobs: 1,
      threads: availableParallelism(),
      seed: run,
      python,
    });
    for (const each of cases) {
      for (const method of answered) {
        const answer = JSON.parse(readFileSync(join(out, method, `${each.name}.json`), "utf8"));
        await add(each, method, 1000 * answer.seconds, answer.cameraFromMesh);
      }
    }
  }
  const time = (/** @type {string} */ method, /** @type {string} */ name) =>
    median(found.filter((one) => one.method === method && one.name === name).map(({ ms }) => ms));
  const rows = ["align", ...peers].map((method) => {
    const times = cases.map(({ name }) => time(method, name));
    const ratios = peers.map((peer) => median(cases.map(({ name }, i) => (times[i] ?? NaN) / time(peer, name))));
    const judged = found.filter((one) => one.method === method && one.isRight !== null);
    const right = judged.filter(({ isRight }) => isRight).length;
    return [method, fixed(median(times)), ...ratios.map((ratio) => fixed(ratio, 2)), `${right}/${judged.length}`];
  });
  console.log(
    `\n${markdownTable([`${cases.length} cases`, "ms", ...peers.map((peer) => `/ ${peer}`), "right"], rows)}`,
  );
  console.log(`
Medians over the cases, ${runs} alternating rounds; a ratio below 1 is faster. Right: scale within 5 %, rotation within 10°,
translation within 5 % of the diameter. Load beforehand: ${fixed(load, 1)}; above 0.5, Open3D's threads wait for one another.`);
}
