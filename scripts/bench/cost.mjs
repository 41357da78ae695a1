/**
 * `npm run bench:cost -- CASE_DIR…`: what an alignment takes as WebAssembly on one thread, against Open3D's FPFH, RANSAC
 * and ICP on all of them, in turn on the same inputs, and how right each is.
 */
import { existsSync, mkdirSync, readdirSync, writeFileSync } from "node:fs";
import { availableParallelism, loadavg } from "node:os";
import { dirname, join, resolve } from "node:path";
import { readTypedCase } from "./case.mjs";
import { command, count } from "./command.mjs";
import { installOpen3d, Open3d } from "./open3d.mjs";
import { builtPackage, packageModule } from "./package.mjs";
import { median } from "./statistics.mjs";
import { fixed, markdownTable } from "./table.mjs";
import { isWithin, loose, strict } from "./tolerance.mjs";

/** @typedef {{ ms: number, bareMs: number, matrix: ArrayLike<number>, stages: Record<string, number> }} Measurement */
/** @typedef {Awaited<ReturnType<typeof readTypedCase>>} Case */
/** @typedef {{ method: string, measurements: Measurement[], evaluations: any[] }} MethodResults */
/** @typedef {{ name: string, points: number, triangles: number, hasTruth: boolean, methods: MethodResults[] }} CaseResults */

/** Ours by name, and their options. */
const presets = {
  fast: { quality: "fast" },
  balanced: { quality: "balanced" },
  best: { quality: "best" },
  paper: { preset: "paper" },
};
/** The peer's: as its tutorial has it, with the scale estimated by RANSAC, and with ICP on thinned clouds, which is faster. */
const peers = { Open3D: {}, "O. scaling": { withScaling: true }, "O. thinned": { thinned: true } };

/**
 * Folders of cases stand for the cases in them.
 * @param {readonly string[]} folders
 */
function caseFolders(folders) {
  const isCase = (/** @type {string} */ folder) => existsSync(join(folder, "camera.json"));
  return folders
    .map((folder) => resolve(folder))
    .flatMap((folder) => {
      if (isCase(folder)) return [folder];
      return readdirSync(folder)
        .sort()
        .map((name) => join(folder, name))
        .filter(isCase);
    });
}

/**
 * Measures all methods on a case, in turn, round by round; a first round, in which caches and compilers warm up, does
 * not count.
 * @param {Case} read
 * @param {any} aligner
 * @param {Open3d} peer
 * @param {number} rounds
 * @returns {Promise<CaseResults>}
 */
async function measure({ name, input, truth }, aligner, peer, rounds) {
  await peer.load(name, input);
  /** @type {Record<string, (seed: number) => Promise<Measurement>>} */
  const methods = {};
  for (const [method, options] of Object.entries(presets)) {
    methods[method] = async () => {
      const begun = performance.now();
      const { matrix, timingsMs } = await aligner.align(input, options);
      const ms = performance.now() - begun;
      return { ms, bareMs: ms - timingsMs.metrics, matrix, stages: timingsMs };
    };
  }
  for (const [method, variant] of Object.entries(peers)) {
    methods[method] = async (seed) => {
      const { ms, stages, matrix } = await peer.align(name, variant, seed);
      return { ms, bareMs: ms, matrix, stages };
    };
  }
  const results = Object.keys(methods).map((method) => ({
    method,
    measurements: /** @type {Measurement[]} */ ([]),
    evaluations: /** @type {any[]} */ ([]),
  }));
  for (let round = 0; round <= rounds; round++) {
    for (const { method, measurements } of results) {
      const measurement = await methods[method]?.(round);
      if (measurement && round > 0) measurements.push(measurement);
    }
  }
  const options = truth ? { truth: truth.matrix, symmetry: truth.symmetry } : {};
  for (const { measurements, evaluations } of results) {
    const seen = new Map();
    for (const { matrix } of measurements) {
      const key = Array.from(matrix).join();
      // Open3D's answer may be no similarity: then it is as wrong as can be.
      if (!seen.has(key)) seen.set(key, await aligner.evaluate(input, { matrix }, options).catch(() => null));
      evaluations.push(seen.get(key));
    }
  }
  const points = input.depth.filter((z, i) => z > 0 && input.mask[i]).length;
  return { name, points, triangles: input.mesh.indices.length / 3, hasTruth: truth !== null, methods: results };
}

/** @param {CaseResults} results @param {string} method */
const millisecondsOf = ({ methods }, method) =>
  median((methods.find((results) => results.method === method)?.measurements ?? []).map(({ ms }) => ms));

/** @param {CaseResults} results */
function caseTable(results) {
  const rows = results.methods.map(({ method, measurements, evaluations }) => {
    const ms = median(measurements.map((measurement) => measurement.ms));
    const metricsApart = method in presets ? fixed(median(measurements.map(({ bareMs }) => bareMs))) : "";
    const ratios = Object.keys(peers).map((peer) => fixed(ms / millisecondsOf(results, peer), 2));
    const errors = evaluations.map((evaluation) => evaluation?.errors);
    const hits = (/** @type {typeof strict} */ tolerance) =>
      results.hasTruth ? `${errors.filter((e) => isWithin(e, tolerance)).length}/${errors.length}` : "–";
    /** @param {string} name @param {number} factor @param {number} digits */
    const error = (name, factor, digits) =>
      results.hasTruth ? fixed(factor * median(errors.map((e) => e?.[name] ?? Number.POSITIVE_INFINITY)), digits) : "–";
    return [
      ...[method, fixed(ms), metricsApart, ...ratios, hits(strict), hits(loose)],
      ...[error("scaleError", 100, 1), error("rotationErrorDeg", 1, 1), error("translationErrorRelative", 100, 1)],
      fixed(median(evaluations.map((evaluation) => evaluation?.metrics.iou ?? 0)), 3),
    ];
  });
  const ratioNames = Object.keys(peers).map((peer) => `/ ${peer}`);
  return markdownTable(
    [
      ...["method", "ms", "ms, no metrics"],
      ...ratioNames,
      "strict",
      "loose",
      "scale %",
      "rotation °",
      "transl. %",
      "IoU",
    ],
    rows,
  );
}

/** @param {readonly CaseResults[]} all */
function summaryTable(all) {
  const known = all.filter(({ hasTruth }) => hasTruth);
  const rows = [...Object.keys(presets), ...Object.keys(peers)].map((method) => {
    const ratios = Object.keys(peers).map((peer) =>
      fixed(median(all.map((results) => millisecondsOf(results, method) / millisecondsOf(results, peer))), 2),
    );
    const evaluations = known.flatMap(({ methods }) => methods.find((m) => m.method === method)?.evaluations ?? []);
    const hits = (/** @type {typeof strict} */ tolerance) =>
      `${evaluations.filter((evaluation) => isWithin(evaluation?.errors, tolerance)).length}/${evaluations.length}`;
    return [method, fixed(median(all.map((r) => millisecondsOf(r, method)))), ...ratios, hits(strict), hits(loose)];
  });
  const ratioNames = Object.keys(peers).map((peer) => `median ratio / ${peer}`);
  return markdownTable(["method", "median ms", ...ratioNames, "strict", "loose"], rows);
}

/** @param {readonly CaseResults[]} all */
function stageTable(all) {
  const rows = Object.keys(peers).map((method) => {
    const measurements = all.flatMap(({ methods }) => methods.find((m) => m.method === method)?.measurements ?? []);
    const stages = Object.keys(measurements[0]?.stages ?? {});
    return [
      method,
      stages.map((stage) => `${stage} ${fixed(median(measurements.map((m) => m.stages[stage] ?? 0)))}`).join(", "),
    ];
  });
  return rows.map(([method, stages]) => `${method}, median ms by stage: ${stages}`).join("\n");
}

/** @param {string[]} folders @param {{ rounds: number, threads: number, python: string, json?: string }} options */
async function cost(folders, { rounds, threads, python, json }) {
  await builtPackage();
  const environmentPython = await installOpen3d(python);
  const aligner = await (await packageModule("index.js")).createAligner();
  const peer = await Open3d.start(environmentPython, threads);
  console.log(
    `\nOurs: WebAssembly on one thread, Node ${process.version}, align() on typed arrays with its metrics. Open3D ` +
      `${peer.version}: native, ${threads} threads, without reading files. Medians of ${rounds} rounds, in turn. ` +
      `Load of the machine beforehand: ${fixed(loadavg()[0], 1)}; above 0.5 Open3D's threads wait for one another.`,
  );
  const all = [];
  try {
    for (const folder of caseFolders(folders)) {
      const results = await measure(await readTypedCase(folder), aligner, peer, rounds);
      all.push(results);
      console.log(`\n### ${results.name}: ${results.points} points, ${results.triangles} triangles\n`);
      console.log(caseTable(results));
    }
  } finally {
    peer.stop();
  }
  console.log(`\n### All ${all.length} cases\n\n${summaryTable(all)}\n\n${stageTable(all)}`);
  console.log(
    "\nOpen3D: FPFH, RANSAC without scale, ICP on all points, as in its tutorial; O. scaling: RANSAC with scale; O. thinned: ICP on the thinned clouds.",
  );
  console.log(
    "A ratio below 1 is faster than Open3D. strict, loose: alignments within 5 %, 10°, 5 % (10 %, 20°, 10 %) of the true scale, rotation and place.",
  );
  if (json === undefined) return;
  mkdirSync(dirname(resolve(json)), { recursive: true });
  writeFileSync(json, `${JSON.stringify({ rounds, threads, open3d: peer.version, cases: all })}\n`);
}

await command("bench:cost", (program) =>
  program
    .description("Times alignments as WebAssembly against Open3D's FPFH, RANSAC and ICP, and tells how right each is.")
    .argument("<case...>", "case folders, or folders of case folders")
    .option("--rounds <n>", "rounds that count", count, 5)
    .option("--threads <n>", "threads of Open3D's; on a busy machine 1 may be faster", count, availableParallelism())
    .option("--python <program>", "the Python, 3.11 or 3.12, that Open3D is installed for", "python3")
    .option("--json <file>", "write everything that was measured")
    .action(cost),
);
