/** `npm run record`: how often this version is right, on every generated set; see `--help`. */
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { command, count } from "./bench/command.mjs";
import { environment, readResults } from "./bench/results.mjs";
import { markdownTable, percent, share } from "./bench/table.mjs";
import { cached } from "./lib/cache.mjs";
import { labCode, runLab, threadArguments } from "./lib/lab.mjs";
import { packageVersion } from "./lib/package.mjs";
import { at } from "./lib/paths.mjs";
import { step } from "./lib/step.mjs";
import { recordFile } from "./record/documents.mjs";
import { cellsOf, heads, reliability, reliabilityHeads, rightOf } from "./record/summary.mjs";

/** @typedef {import("./bench/results.mjs").ResultRow & { set: string }} Result */
/** @typedef {{ quick: boolean, check?: boolean, save?: boolean, only?: string[], threads?: number }} RecordOptions */

/** Rows of options of the lab, by their names. @param {Record<string, string>} options */
const rows = (options) => Object.entries(options).flatMap(([name, text]) => ["--row", `${name}: ${text}`]);

/**
 * The generated sets: numbers of cases, whole and quick; the set of the lab where its name is another; rows in place of its own.
 * @type {Record<string, { cases: readonly [whole: number, quick: number], of?: string, more?: readonly string[] }>}
 */
const sets = {
  general: { cases: [480, 72] },
  sensors: { cases: [264, 33] },
  colors: { cases: [168, 12] },
  surplus: {
    ...{ cases: [48, 4], of: "general" },
    more: rows({ floaters: "surplus=floaters", plate: "surplus=plate" }),
  },
  models: {
    ...{ cases: [48, 3], of: "general" },
    more: rows({
      ...{ affine: "model=affine", disparity: "model=disparity", "no-camera": "model=no-camera" },
      "disparity-no-camera": "model=disparity-no-camera",
    }),
  },
  scenes: { cases: [60, 6] },
  placements: {
    ...{ cases: [24, 2], of: "scenes" },
    more: rows({ alone: "initial=true", together: "call=scene initial=true" }),
  },
  videos: { cases: [12, 1] },
  views: {
    ...{ cases: [12, 1], of: "videos" },
    more: rows({ "known cameras": "call=views views=4", "unknown cameras": "call=views views=4 cameras=false" }),
  },
};
/** Sets with hints, and the frames of a video, which are not found independently, say nothing of confidences. */
const hinted = ["placements", "videos"];
/** A seed with which nothing was tuned. */
const SEED = "7";

/** What `--check` compares with: by set and row, the cases that are right, and the work of all. */
const quickFile = at("docs", "record", "quick.json");
/** Cases of all sets that may no longer be right, and the growth of the work that is no fault. */
const MOST_LOST = 2;
const MOST_WORK = 1.05;

/** @param {RecordOptions} options @returns {Promise<Result[]>} */
async function measured({ quick, only, threads }) {
  const given = quick ? undefined : process.env.SIM3ALIGN_CASES;
  const code = labCode(given === undefined ? [] : [given]);
  const folder = at("target", "bench", "record", `${quick ? "quick" : "whole"}-${code.slice(0, 12)}`);
  mkdirSync(folder, { recursive: true });

  const inputs = Object.entries(sets).map(([set, { cases, of = set, more = [] }]) => {
    const args = ["--set", of, "--count", `${cases[quick ? 1 : 0]}`, "--seed", SEED, ...more];
    return /** @type {const} */ ([set, args]);
  });
  if (given !== undefined) inputs.push(["given", ["--cases", given]]);
  const results = [];
  for (const [set, args] of inputs) {
    if (only !== undefined && !only.includes(set)) continue;
    const file = join(folder, `${set}.jsonl`);
    const run = async () => {
      await runLab(["bench", ...args, "--json", file, ...threadArguments(threads)]);
    };
    await step(set, () => cached(`${file}.done`, [code, ...args].join(), [file], run));
    results.push(...readResults(file).map((result) => ({ ...result, set })));
  }
  return results;
}

/** The results of each row of each set, by the names of both. @param {readonly Result[]} results */
function byRow(results) {
  const names = new Set(results.map(({ set, row }) => `${set} | ${row}`));
  return Array.from(
    names,
    (name) => /** @type {const} */ ([name, results.filter(({ set, row }) => `${set} | ${row}` === name)]),
  );
}

/** Poses whose confidence is a measurement: found without a hint, by all that was seen. @param {readonly Result[]} results */
const unaided = (results) => results.filter(({ set, row }) => !hinted.includes(set) && row !== "shape alone");

/** @param {readonly Result[]} results */
function tables(results) {
  const rows = byRow(results).map(([name, of]) => [...name.split(" | "), ...cellsOf(of)]);
  return [
    markdownTable(["set", "call", ...heads], rows),
    markdownTable(reliabilityHeads, reliability(unaided(results))),
  ];
}

/** The page of the record. @param {readonly Result[]} results */
async function page(results) {
  const { commit, date, machine, rustc } = await environment();
  const single = results.filter(({ set }) => set === "general");
  const sure = unaided(results).filter(({ confidence }) => (confidence ?? 0) >= 0.9);
  const [accuracy, confidences] = tables(results);
  return `# The record

Of all poses with a confidence of 0.9 or more, ${rightOf(sure)} are right. Of ${single.length} generated objects,
${percent(share(single.map(({ strict }) => strict === true)))} % are placed strictly right.

![The share of right poses over their confidence, near the diagonal; the share of strictly right poses, a dot for each row of each set](record/accuracy.svg)

Version ${packageVersion()}, commit ${commit.slice(0, 10)}, ${date.slice(0, 10)}, ${machine}, ${rustc}. Written by \`npm run record -- --save\`:
all cases are generated from a seed with which nothing was tuned, and the same commit gives the same rows to the bit. Other libraries
on the same cases are in [the benchmark](benchmark.md); what to do with a confidence is in
[reading a result](guides/reading-confidence.md), and what the calls are in [calls and presets](guides/choosing-a-preset.md).

## By set

*Strict* is a scale within 5 %, a rotation within 10° up to symmetry and a translation within 5 % of the diameter; *loose* is twice
that. Of monocular depth, the apparent size and the place in the image count instead. Errors are medians of the answered cases.
*Believed* are poses with a confidence of 0.9 or more; of these, *size in interval* is the share of sizes within 1.645 times the standard
deviation that the result states: 90 would be exact. Times are CPU time of the native build.

${accuracy}

## How far a confidence can be trusted

Poses without hints, videos, and objects whose photo was withheld:

${confidences}
`;
}

/** What \`--check\` compares. @param {readonly Result[]} results */
const quickRecord = (results) =>
  Object.fromEntries(
    byRow(results).map(([row, of]) => {
      const right = of.filter(({ strict }) => strict).map(({ name }) => name);
      return [row, { right, renders: of.reduce((sum, { work }) => sum + (work?.renders ?? 0), 0) }];
    }),
  );

/** Regressions from the committed record. @param {ReturnType<typeof quickRecord>} now @returns {string[]} */
function losses(now) {
  /** @type {typeof now} */
  const before = JSON.parse(readFileSync(quickFile, "utf8"));
  const lost = Object.entries(before).flatMap(([row, { right }]) =>
    right.filter((name) => !now[row]?.right.includes(name)).map((name) => `${row}: ${name} is no longer right`),
  );
  const work = Object.entries(before).flatMap(([row, { renders }]) => {
    const growth = (now[row]?.renders ?? 0) / renders;
    return growth > MOST_WORK ? [`${row}: ${growth.toFixed(2)} times as many renders`] : [];
  });
  return [...(lost.length > MOST_LOST ? lost : []), ...work];
}

/** @param {RecordOptions} options */
async function record(options) {
  const { quick, check, save, only } = options;
  if (only !== undefined && (save || check))
    throw new Error("--only goes without --save and --check. Remedy: leave it out.");
  if (check && !quick) throw new Error("--check goes with --quick. Remedy: add it.");
  const results = await measured(options);
  console.log(`\n${tables(results).join("\n\n")}\n`);

  if (save && quick) writeFileSync(quickFile, `${JSON.stringify(quickRecord(results), null, 1)}\n`);
  else if (save) writeFileSync(recordFile, await page(results.filter(({ set }) => set !== "given")));
  const worse = check ? losses(quickRecord(results)) : [];
  if (worse.length > 0) throw new Error(`Worse than docs/record/quick.json:\n${worse.join("\n")}`);
}

await command("record", (program) =>
  program
    .description("Measures this version on every generated set. An interrupted run is resumed.")
    .option("--quick", "a part of each set", false)
    .option(
      "--check",
      `with --quick: fails if more than ${MOST_LOST} cases that are right in docs/record/quick.json are not`,
    )
    .option(
      "--save",
      "writes docs/record.md, from which documents take their figures; with --quick, docs/record/quick.json",
    )
    .option("--only <a,b,…>", "some of the sets; without --save and --check", (text) => text.split(","))
    .option("--threads <n>", "all by default", count)
    .action(record),
);
