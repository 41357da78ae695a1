/**
 * `npm run bench [-- --quick]`: the whole benchmark: generated scenes (or case folders), every method and ablation, other
 * libraries beside them, general registration; tables and figures of it all. An interrupted run is resumed.
 */
import { mkdirSync, readdirSync } from "node:fs";
import { join, resolve } from "node:path";
import { digest } from "../lib/cache.mjs";
import { buildLab, runLab } from "../lib/lab.mjs";
import { at } from "../lib/paths.mjs";
import { pythonWith } from "../lib/python.mjs";
import { duration, step } from "../lib/step.mjs";
import { command, count } from "./command.mjs";
import { datasets, generalJobs, generalTable, importJob, ownJob, peersJob } from "./jobs.mjs";
import { report } from "./paper/report.mjs";
import { tableSpecs } from "./paper/rows.mjs";
import { meshMethods, versionsOf } from "./peers.mjs";
import { environment, openResults } from "./results.mjs";

/**
 * @typedef {object} BenchmarkOptions
 * @property {boolean} quick
 * @property {number} [scenes]
 * @property {number} setSeed
 * @property {string} [cases]
 * @property {string[]} import
 * @property {string[]} data
 * @property {boolean} peers
 * @property {string} python
 * @property {string} [out]
 * @property {boolean} fresh
 * @property {boolean} snapshot
 * @property {number} [threads]
 */

const collect = (/** @type {string} */ value, /** @type {string[]} */ all) => [...all, value];

await command("bench", (program) =>
  program
    .description("Runs the benchmark and writes its tables and figures. An interrupted run is resumed.")
    .option("--quick", "a subset that takes about five minutes", false)
    .option("--scenes <n>", "generated scenes: 100 make 338 pairs of object and mesh (12 where --quick)", count)
    .option("--set-seed <s>", "seed of the generated scenes", Number, 0)
    .option("--cases <dir>", "case folders in place of the generated scenes")
    .option("--import <name=dir>", "answers of another program, a JSON file a case; may be repeated", collect, [])
    .option("--data <dir>", "3DMatch, 3DLoMatch or KITTI for general registration; may be repeated", collect, [])
    .option("--no-peers", "leave out the other libraries, and the Python that they need")
    .option(
      "--python <program>",
      "the Python (3.11 or 3.12) that the other libraries get an environment from",
      "python3",
    )
    .option("--out <dir>", "where results are kept; benches/results/… by default")
    .option("--fresh", "forget what an earlier run has left there", false)
    .option("--snapshot", "write tables and figures to docs/benchmark/ too", false)
    .option("--threads <n>", "all by default", count)
    .action(benchmark),
);

/** @param {BenchmarkOptions} options */
async function benchmark(options) {
  const started = performance.now();
  const scenes = options.scenes ?? (options.quick ? 12 : 100);
  const name = options.cases === undefined ? `scenes-${scenes}-seed-${options.setSeed}` : "cases";
  const out = resolve(options.out ?? at("benches", "results", name));
  await step("Programs", buildLab);
  if (options.peers) await pythonWith("peers", options.python);
  /** @type {Record<string, string>} */
  const folders = options.cases === undefined ? await writeScenes(scenes, options.setSeed) : { given: options.cases };
  const clouds = await datasets(options);

  const code = digest([at("src"), at("geometry"), at("formats"), at("lab"), at("Cargo.toml"), at("Cargo.lock")]);
  const identity = { code, scenes, setSeed: options.setSeed, cases: options.cases ?? null, clouds };
  openResults(out, identity, options.fresh);

  const [prior = "", folder = ""] = Object.entries(folders)[0] ?? [];
  const answers = join(out, "answers", prior);
  const methods = options.peers ? meshMethods(options.quick) : {};
  /** @type {[string, string][]} */
  const imports = [
    ...Object.keys(methods).map((method) => /** @type {[string, string]} */ ([method, join(answers, method)])),
    ...options.import.map(namedFolder),
  ];
  const names = imports.map(([importName]) => importName);
  const specs = tableSpecs(names, Object.keys(folders));
  const jobs = Object.entries(folders).map(([each, cases]) => ownJob(specs, each, cases, out, options.threads));
  if (options.peers) jobs.push(peersJob(methods, folder, answers, options.python));
  if (imports.length > 0) jobs.push(importJob(imports, folder, prior, out));
  for (const set of clouds) jobs.push(...(await generalJobs(set, out, options.peers ? options.python : null)));
  await runAll(jobs);

  const software = options.peers ? versionsOf(answers) : {};
  const run = { ...(await environment()), software, setSeed: options.setSeed, scenes };
  const general = clouds.map((set) => generalTable(set, out));
  const markdown = await report({ specs, out, run, folders, general, snapshot: options.snapshot });
  console.log(`\n${markdown}\nTables and figures are in ${out}; all took ${duration(performance.now() - started)}.`);
}

/** Runs jobs beneath one bar with the time that is left. @param {readonly import("./jobs.mjs").Job[]} jobs */
async function runAll(jobs) {
  const { SingleBar, Presets } = (await import("cli-progress")).default;
  const format = "{bar} {percentage}% | {eta_formatted} left | {task}";
  const options = { format, noTTYOutput: true, notTTYSchedule: 30_000, hideCursor: true, linewrap: false };
  const bar = new SingleBar(options, Presets.shades_classic);
  bar.start(
    jobs.reduce((sum, { work }) => sum + work, 0),
    0,
    { task: "" },
  );
  const advance = (/** @type {number} */ seconds, task = "") => bar.increment(seconds, { task });
  try {
    for (const job of jobs) await job.run({ advance });
  } finally {
    bar.stop();
  }
}

/**
 * Case folders of both mesh priors, below target/.
 * @param {number} scenes
 * @param {number} seed
 */
async function writeScenes(scenes, seed) {
  const folder = at("target", "bench", `scenes-${scenes}-seed-${seed}`);
  await step("Scenes", async (say) => {
    mkdirSync(folder, { recursive: true });
    const args = ["scenes", folder, "--scenes", `${scenes}`, "--set-seed", `${seed}`, "--prior", "both"];
    await runLab(args);
    say(`${readdirSync(join(folder, "detailed")).length} pairs`);
  });
  return { detailed: join(folder, "detailed"), smooth: join(folder, "smooth") };
}

/** @param {string} text NAME=DIR @returns {[string, string]} */
function namedFolder(text) {
  const [, name, folder] = /^([^=]+)=(.+)$/.exec(text) ?? [];
  if (name === undefined || folder === undefined) throw new Error(`--import: found ${text}, expected NAME=DIR`);
  return [name, resolve(folder)];
}
