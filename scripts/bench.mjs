/**
 * `npm run bench [-- --quick]`: the paper's tables: generated scenes (or case folders), our presets and their ablations,
 * other libraries beside them, general registration. An interrupted run is resumed.
 */
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { basename, join, resolve } from "node:path";
import { command, count } from "./bench/command.mjs";
import { notes, ownRows, tableMarkdown, tables } from "./bench/paper.mjs";
import { meshMethods, pairMethods, runPeers, versionsOf } from "./bench/peers.mjs";
import { environment, openResults, readResults } from "./bench/results.mjs";
import { cached } from "./lib/cache.mjs";
import { buildLab, labCode, runLab, threadArguments } from "./lib/lab.mjs";
import { at } from "./lib/paths.mjs";
import { pythonWith } from "./lib/python.mjs";
import { step } from "./lib/step.mjs";

/**
 * @typedef {object} BenchmarkOptions
 * @property {boolean} quick
 * @property {boolean} smallest
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
    .description("Runs the benchmark of the paper, and writes its tables. An interrupted run is resumed.")
    .option("--quick", "a subset that takes about three minutes", false)
    .option("--smallest", "one scene and a few pairs of clouds, without other libraries", false)
    .option("--scenes <n>", "generated scenes: 100 make 338 pairs of object and mesh (12 where --quick)", count)
    .option("--set-seed <s>", "seed of the generated scenes", Number, 0)
    .option("--cases <dir>", "case folders in place of the generated scenes")
    .option("--import <name=dir>", "answers of another program, a JSON file a case; may be repeated", collect, [])
    .option("--data <dir>", "3DMatch, 3DLoMatch or KITTI for general registration; may be repeated", collect, [])
    .option("--no-peers", "leave out the other libraries, and the Python that they need")
    .option("--python <program>", "the Python (3.11 or 3.12) that installs the other libraries", "python3")
    .option("--out <dir>", "where results are kept; benches/results/… by default")
    .option("--fresh", "forget what an earlier run has left there", false)
    .option("--snapshot", "write the tables to docs/benchmark/ too", false)
    .option("--threads <n>", "all by default", count)
    .action(benchmark),
);

/** @param {BenchmarkOptions} options */
async function benchmark(options) {
  const scenes = options.scenes ?? (options.smallest ? 1 : options.quick ? 12 : 100);
  const name = options.cases === undefined ? `scenes-${scenes}-seed-${options.setSeed}` : "cases";
  const out = resolve(options.out ?? at("benches", "results", name));
  const hasPeers = options.peers && !options.smallest;
  await step("Programs", buildLab);
  if (hasPeers) await pythonWith("peers", options.python);
  const code = labCode();
  const clouds = await datasets(options, code);
  openResults(out, { code, scenes, setSeed: options.setSeed, cases: options.cases ?? null, clouds }, options.fresh);
  const folders =
    options.cases === undefined ? await writeScenes(scenes, options.setSeed, code) : { given: options.cases };

  const [[prior, folder] = ["", ""]] = Object.entries(folders);
  const answers = join(out, "answers");
  const methods = hasPeers ? meshMethods(options.quick) : [];
  const peers = { cases: [folder], out: answers, methods, python: options.python };
  const answered = hasPeers ? await step("Other libraries", () => runPeers(peers)) : [];
  const imports = [...answered.map((method) => `${method}=${join(answers, method)}`), ...options.import];
  const file = (/** @type {string} */ of) => join(out, `${of}.jsonl`);
  for (const [each, cases] of Object.entries(folders)) {
    const args = ownRows(each === prior).flatMap((row) => ["--row", row]);
    if (each === prior) args.push(...imports.flatMap((one) => ["--import", one]));
    await step(`Rows on ${each} meshes`, () =>
      runLab(["bench", "--cases", cases, ...args, "--json", file(each), ...threadArguments(options.threads)]),
    );
  }
  const results = new Map(Object.keys(folders).map((each) => [each, readResults(file(each))]));
  const names = imports.map((one) => one.split("=")[0] ?? "");
  const sections = tables(names, Object.keys(folders)).map(
    (table) => `## ${table.title}\n\n${tableMarkdown(table, (each) => results.get(each) ?? [])}`,
  );
  for (const set of clouds) sections.push(await registration(set, out, hasPeers ? options.python : null));

  const { commit, date, machine, system, node, rustc } = await environment();
  const libraries = hasPeers ? Object.entries(versionsOf(answers)).map((library) => library.join(" ")) : [];
  const versions = [rustc, `Node ${node}`, ...libraries].join(", ");
  const run = `Commit ${commit}, ${date.slice(0, 10)}, ${machine}, ${system}; ${versions}. Set seed ${options.setSeed}, ${scenes} scenes.`;
  const lost = methods.filter((method) => !answered.includes(method));
  const left = lost.length === 0 ? "" : `Left out, because their library could not be loaded: ${lost.join(", ")}.\n\n`;
  const markdown = `# Benchmark\n\n${run}\n\n${left}${notes}\n\n${sections.join("\n\n")}\n`;
  writeFileSync(join(out, "tables.md"), markdown);
  if (options.snapshot) writeFileSync(at("docs", "benchmark", "README.md"), markdown);
  console.log(`\n${markdown}\nThe tables are in ${out}.`);
}

/**
 * Case folders of both mesh priors, below target/.
 * @param {number} scenes
 * @param {number} seed
 * @param {string} code
 */
async function writeScenes(scenes, seed, code) {
  const folder = at("target", "bench", `scenes-${scenes}-seed-${seed}`);
  const folders = { detailed: join(folder, "detailed"), smooth: join(folder, "smooth") };
  await step("Scenes", async () => {
    const size = ["--count", `${scenes}`, "--seed", `${seed}`];
    await generated(folders.detailed, code, ["bench", "--set", "clutter", ...size, "--write", folders.detailed]);
    await generated(folders.smooth, code, ["bench", "--set", "clutter-smooth", ...size, "--write", folders.smooth]);
  });
  return folders;
}

/**
 * Inputs that the lab writes to a folder; again if its code has changed.
 * @param {string} folder
 * @param {string} code
 * @param {readonly string[]} args
 */
async function generated(folder, code, args) {
  await cached(`${folder}.done`, code, [folder], async () => {
    rmSync(folder, { recursive: true, force: true });
    await runLab(args);
  });
}

/** @typedef {{ id: string, title: string, data: string, every: number }} Dataset every n-th pair is taken */

/**
 * The pairs of clouds of a run: rooms and streets of its seed, and folders of the caller's.
 * @param {{ quick: boolean, smallest: boolean, setSeed: number, data: readonly string[] }} options
 * @param {string} code
 * @returns {Promise<Dataset[]>}
 */
async function datasets({ quick, smallest, setSeed, data }, code) {
  const scenes = quick || smallest ? 1 : 2;
  /** @type {Dataset[]} */
  const made = [];
  for (const [kind, title] of [
    ["rooms", "rooms in 3DMatch's layout"],
    ["lidar", "streets in KITTI's layout"],
  ]) {
    const folder = at("target", "bench", `${kind}-${scenes}-seed-${setSeed}`);
    const size = ["--seed", `${setSeed}`, "--scenes", `${scenes}`];
    await generated(folder, code, ["registration", "write", `${kind}`, folder, ...size]);
    made.push({ id: `${kind}`, title: `generated ${title}`, data: folder, every: smallest ? 12 : quick ? 3 : 1 });
  }
  return [
    ...made,
    ...data.map((path) => ({ id: basename(path), title: basename(path), data: resolve(path), every: 1 })),
  ];
}

/**
 * The table of general registration.
 * @param {Dataset} set
 * @param {string} out
 * @param {string | null} python the Python of the other libraries, or none of them
 */
async function registration({ id, title, data, every }, out, python) {
  const folder = join(out, "registration", id);
  mkdirSync(folder, { recursive: true });
  const args = ["registration", "run", "--data", data, "--every", `${every}`];
  const methods = ["--method", "register"];
  if (python !== null) {
    const [pairs, answers] = [join(folder, "pairs.json"), join(folder, "answers")];
    await runLab([...args, "--pairs-json", pairs]);
    const peers = { pairs, out: answers, methods: pairMethods, python };
    const answered = await step(`Other libraries, ${title}`, () => runPeers(peers));
    methods.push(...answered.flatMap((name) => ["--method", `${name}=import:${join(answers, name)}`]));
  }
  const table = join(folder, "table.md");
  await step(`General registration, ${title}`, async () => {
    const records = ["--records", join(folder, "records.jsonl")];
    writeFileSync(table, await runLab([...args, "--measure-overlap", ...methods, ...records]));
  });
  return `## General registration, ${title}\n\n${readFileSync(table, "utf8").trim()}`;
}
