/**
 * `npm run bench [-- --quick]`: the paper's tables: generated scenes (or case folders), our presets and their ablations,
 * other libraries beside them, general registration. An interrupted run is resumed.
 */
import { rmSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
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
  openResults(out, { code, scenes, setSeed: options.setSeed, cases: options.cases ?? null }, options.fresh);
  const folder = options.cases ?? (await writeScenes(scenes, options.setSeed, code));

  const answers = join(out, "answers");
  const methods = hasPeers ? meshMethods(options.quick) : [];
  const peers = { cases: [folder], out: answers, methods, python: options.python };
  const answered = hasPeers ? await step("Other libraries", () => runPeers(peers)) : [];
  const imports = [...answered.map((method) => `${method}=${join(answers, method)}`), ...options.import];
  const file = join(out, "scenes.jsonl");
  const rows = [...ownRows.flatMap((row) => ["--row", row]), ...imports.flatMap((one) => ["--import", one])];
  await step("Rows", () =>
    runLab(["bench", "--cases", folder, ...rows, "--json", file, ...threadArguments(options.threads)]),
  );
  const results = readResults(file);
  const sections = tables(imports.map((one) => one.split("=")[0] ?? "")).map(
    (table) => `## ${table.title}\n\n${tableMarkdown(table, results)}`,
  );
  sections.push(await registration(options, out));

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
 * Case folders of the objects of scenes, below target/.
 * @param {number} scenes
 * @param {number} seed
 * @param {string} code
 */
async function writeScenes(scenes, seed, code) {
  const folder = at("target", "bench", `scenes-${scenes}-seed-${seed}`);
  await step("Scenes", () =>
    cached(`${folder}.done`, code, [folder], async () => {
      rmSync(folder, { recursive: true, force: true });
      const size = ["--count", `${scenes}`, "--seed", `${seed}`];
      await runLab(["bench", "--set", "scenes", ...size, "--split", "--write", folder]);
    }),
  );
  return folder;
}

/**
 * The table of general registration: pairs of scans of generated rooms.
 * @param {BenchmarkOptions} options
 * @param {string} out
 */
async function registration({ quick, smallest, setSeed, peers, python, threads }, out) {
  const [rooms, every] = smallest ? [1, 12] : quick ? [1, 3] : [2, 1];
  const args = ["bench", "--rooms", `${rooms}`, "--every", `${every}`, "--seed", `${setSeed}`];
  const rows = ["--row", "register:"];
  if (peers && !smallest) {
    const [pairs, answers] = [join(out, "rooms"), join(out, "room-answers")];
    await runLab([...args, "--write", pairs]);
    const run = { pairs: join(pairs, "pairs.json"), out: answers, methods: pairMethods, python };
    const answered = await step("Other libraries, rooms", () => runPeers(run));
    rows.push(...answered.flatMap((name) => ["--import", `${name}=${join(answers, name)}`]));
  }
  const json = ["--json", join(out, "rooms.jsonl"), ...threadArguments(threads)];
  const table = await step("General registration", () => runLab([...args, ...rows, ...json]));
  return `## General registration, generated rooms\n\n${table.trim()}`;
}
