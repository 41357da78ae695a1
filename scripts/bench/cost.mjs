/**
 * `npm run bench:cost -- CASE_DIR…`: time and success of alignments as WebAssembly on one thread, alternating with Open3D's
 * FPFH, RANSAC and ICP on all threads.
 */
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { availableParallelism, loadavg } from "node:os";
import { dirname, join, resolve } from "node:path";
import { buildPackage } from "../lib/package.mjs";
import { at } from "../lib/paths.mjs";
import { command, count } from "./command.mjs";
import { packageModule, qualities, readTypedCase } from "./inputs.mjs";
import { caseFolders, runPeers } from "./peers.mjs";
import { isWithin, loose, strict, typicalError } from "./records.mjs";
import { fixed, markdownTable, median } from "./table.mjs";

/** Our methods by name, and their options. @returns {Promise<[name: string, options: object][]>} */
const presets = async () => [
  ...(await qualities()).map((quality) => /** @type {[string, object]} */ ([quality, { quality }])),
  ["paper", { preset: "paper" }],
];
/** Open3D's tutorial; RANSAC estimates the scale too; ICP on thinned clouds. */
const peers = ["open3d-ransac", "open3d-ransac-scale", "open3d-ransac-thinned"];

/** @typedef {Awaited<ReturnType<typeof readTypedCase>>} Case */
/** @typedef {{ method: string, ms: number, errors: any, iou: number }} Measurement without errors where the truth is unknown */
/** @typedef {{ name: string, measurements: Measurement[] }} CaseResults */

/**
 * Our methods on a case.
 * @param {any} aligner
 * @param {Case} read
 * @returns {Promise<Measurement[]>}
 */
async function measureOurs(aligner, { input, truth }) {
  const measurements = [];
  for (const [method, options] of await presets()) {
    const begun = performance.now();
    const pose = await aligner.align(input, options);
    const ms = performance.now() - begun;
    measurements.push({ method, ms, ...(await judge(aligner, input, truth, pose)) });
  }
  return measurements;
}

/**
 * @param {any} aligner
 * @param {Case["input"]} input
 * @param {Case["truth"]} truth
 * @param {object | undefined} pose
 */
async function judge(aligner, input, truth, pose) {
  const options = truth ? { truth: truth.matrix, symmetry: truth.symmetry } : {};
  // No answer, or none that is a similarity, is wrong.
  const evaluation = pose && (await aligner.evaluate(input, pose, options).catch(() => undefined));
  return { errors: evaluation?.errors, iou: evaluation?.metrics.iou ?? 0 };
}

/** @param {readonly CaseResults[]} all @param {string} method */
const of = (all, method) => all.flatMap(({ measurements }) => measurements.filter((one) => one.method === method));

/** @param {readonly CaseResults[]} all @param {string} method */
const milliseconds = (all, method) => median(of(all, method).map(({ ms }) => ms));

/** Times, ratios (medians over the cases) and success. @param {readonly CaseResults[]} all @param {boolean} hasTruth */
function table(all, hasTruth) {
  const methods = new Set(all.flatMap(({ measurements }) => measurements.map(({ method }) => method)));
  const rows = [...methods].map((method) => {
    const measurements = of(all, method);
    const ratios = peers.map((peer) =>
      median(all.map((results) => milliseconds([results], method) / milliseconds([results], peer))),
    );
    const hits = (/** @type {typeof strict} */ tolerance) =>
      `${measurements.filter(({ errors }) => isWithin(errors, tolerance)).length}/${measurements.length}`;
    const percent = (/** @type {"scaleError" | "translationErrorRelative"} */ name) =>
      fixed(100 * typicalError(measurements, name), 1);
    const rotation = fixed(typicalError(measurements, "rotationErrorDeg"), 1);
    const accuracy = [hits(strict), hits(loose), percent("scaleError"), rotation, percent("translationErrorRelative")];
    const cells = [method, fixed(milliseconds(all, method)), ...ratios.map((ratio) => fixed(ratio, 2))];
    return [
      ...cells,
      ...accuracy.map((cell) => (hasTruth ? cell : "–")),
      fixed(median(measurements.map(({ iou }) => iou)), 3),
    ];
  });
  const head = ["method", "ms", ...peers.map((_, i) => `/ Open3D ${"abc"[i]}`), "strict", "loose"];
  return markdownTable([...head, "scale %", "rotation °", "transl. %", "IoU"], rows);
}

/** @param {string[]} folders @param {{ rounds: number, threads: number, python: string, json?: string }} options */
async function cost(folders, { rounds, threads, python, json }) {
  await buildPackage();
  const aligner = await (await packageModule("index.js")).createAligner();
  const cases = await Promise.all(caseFolders(folders).map(readTypedCase));
  /** @type {Map<string, CaseResults>} */
  const results = new Map(cases.map(({ name }) => [name, { name, measurements: [] }]));
  const load = loadavg()[0];
  // In the first round caches and compilers warm up.
  for (let round = 0; round <= rounds; round++) {
    const out = at("target", "bench", "cost");
    rmSync(out, { recursive: true, force: true });
    for (const read of cases) {
      const measurements = await measureOurs(aligner, read);
      if (round > 0) results.get(read.name)?.measurements.push(...measurements);
    }
    if (round === 0) continue;
    await runPeers({ cases: folders, out, methods: peers, jobs: 1, threads, seed: round, python });
    for (const { name, input, truth } of cases) {
      for (const method of peers) {
        const { seconds, cameraFromMesh } = JSON.parse(readFileSync(join(out, method, `${name}.json`), "utf8"));
        const judged = await judge(aligner, input, truth, cameraFromMesh);
        results.get(name)?.measurements.push({ method, ms: 1000 * seconds, ...judged });
      }
    }
  }
  const all = [...results.values()];
  for (const [i, { name, input, truth }] of cases.entries()) {
    console.log(
      `\n### ${name}: ${input.mesh.indices.length / 3} triangles\n\n${table(all.slice(i, i + 1), truth !== null)}`,
    );
  }
  const known = cases.every(({ truth }) => truth !== null);
  console.log(`\n### All ${all.length} cases\n\n${table(all, known)}`);
  console.log(`
Ours: WebAssembly on one thread, Node ${process.version}, with metrics. Open3D: native, ${threads} threads, without reading
files; a: its tutorial's FPFH, RANSAC without scale and ICP on all points, b: RANSAC with scale, c: ICP on thinned clouds.
A ratio below 1 is faster. Medians of ${rounds} alternating rounds. Load of the machine beforehand: ${fixed(load, 1)}; above
0.5 Open3D's threads wait for one another. strict, loose: within 5 %, 10°, 5 % (10 %, 20°, 10 %) of the true scale, rotation
and place.`);
  if (json === undefined) return;
  mkdirSync(dirname(resolve(json)), { recursive: true });
  writeFileSync(json, `${JSON.stringify({ rounds, threads, cases: all })}\n`);
}

await command("bench:cost", (program) =>
  program
    .description(
      "Times alignments as WebAssembly against Open3D's FPFH, RANSAC and ICP, and reports the accuracy of each.",
    )
    .argument("<case...>", "case folders, or folders of case folders")
    .option("--rounds <n>", "rounds that count", count, 5)
    .option("--threads <n>", "threads of Open3D's; on a busy machine 1 may be faster", count, availableParallelism())
    .option("--python <program>", "the Python, 3.11 or 3.12, that Open3D is installed for", "python3")
    .option("--json <file>", "write everything that was measured")
    .action(cost),
);
