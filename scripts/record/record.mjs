/**
 * `npm run record`: the accuracy of this version on every set of `sets.mjs`, as one file: each case with its errors,
 * confidence and time. An interrupted run is resumed. `--quick` takes a part of each set, of which the repository keeps the
 * last one; `--check` compares with that, and fails if anything has become worse.
 */
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { environment, readResults } from "../bench/results.mjs";
import { markdownTable } from "../bench/table.mjs";
import { cached } from "../lib/cache.mjs";
import { labCode, runLab, threadArguments } from "../lib/lab.mjs";
import { packageVersion } from "../lib/package.mjs";
import { at } from "../lib/paths.mjs";
import { step } from "../lib/step.mjs";
import { sizes, wasmFile, wasmModules } from "../lib/wasm.mjs";
import { losses } from "./guard.mjs";
import { extendHistory } from "./history.mjs";
import { givenSet, sets } from "./sets.mjs";
import { cellsOf, head, reliability, rounded, summaries } from "./summary.mjs";

/** The quick record that changes are compared with. */
const quickFile = at("docs", "record", "quick.json");

/**
 * @typedef {object} RecordOptions
 * @property {boolean} [quick]
 * @property {boolean} [check]
 * @property {boolean} [save]
 * @property {string} [out]
 * @property {boolean} [fresh]
 * @property {readonly string[]} [only] sets, for a look at them
 * @property {number} [threads]
 */

/** @param {RecordOptions} options */
export async function record({ quick = false, check, save, out, fresh = false, only, threads }) {
  if (only !== undefined && (save || check)) {
    throw new Error("Found --only with --save or --check. Remedy: leave it out; a record is whole.");
  }
  const given = quick ? undefined : process.env.SIM3ALIGN_CASES;
  const code = labCode([at("scripts", "record", "sets.mjs")], given === undefined ? [] : [given]);
  // Results of other code, or of other cases, stay, and are not taken for those of this one.
  const folder = resolve(out ?? at("target", "bench", "record"), `${quick ? "quick" : "whole"}-${code.slice(0, 12)}`);
  if (fresh) rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  const found = [];
  for (const set of given === undefined ? sets : [...sets, givenSet(given)]) {
    const count = set.cases[quick ? 1 : 0];
    if (count === 0 || !(only?.includes(set.name) ?? true)) continue;
    const file = join(folder, `${set.name}.jsonl`);
    await step(set.title, async (say) => {
      const ran = await cached(`${file}.done`, code, [file], async () => {
        await runLab([...set.args(count), "--json", file, ...threadArguments(threads)]);
      });
      if (!ran) say("done before");
    });
    if (existsSync(file)) found.push({ set: set.name, results: readResults(file) });
  }
  const rows = found.flatMap(({ set, results }) => summaries(set, results));
  console.log(`\n${markdownTable(head, rows.map(cellsOf))}\n`);
  console.log(`${markdownTable(["confidence", "poses", "right %"], reliability(rows))}\n`);
  const version = packageVersion();
  const modules = wasmModules.filter((module) => existsSync(wasmFile(module)));
  const measured = Object.fromEntries(modules.map((module) => [module.name, sizes(wasmFile(module)).gzip]));
  const now = {
    version,
    sizes: measured,
    sets: found.map(({ set, results }) => ({ set, work: workOf(results), lines: linesOf(results) })),
  };
  if (save && quick) {
    mkdirSync(at("docs", "record"), { recursive: true });
    writeFileSync(quickFile, `${JSON.stringify(now).replaceAll('},{"row"', '},\n{"row"')}\n`);
  } else if (save) {
    extendHistory({ version, ...(await environment()), sizes: measured }, rows);
  }
  return check ? losses(JSON.parse(readFileSync(quickFile, "utf8")), now) : [];
}

/** The sums of the counts of work, by row. @param {readonly import("../bench/results.mjs").ResultRow[]} results */
function workOf(results) {
  /** @type {Record<string, Record<string, number>>} */
  const sums = {};
  for (const { row, work } of results) {
    for (const [name, count] of Object.entries(work ?? {})) {
      sums[row] ??= {};
      sums[row][name] = (sums[row][name] ?? 0) + count;
    }
  }
  return sums;
}

/**
 * Results as the quick record keeps them: without times, which differ from run to run, and with four digits.
 * @param {readonly import("../bench/results.mjs").ResultRow[]} results
 * @returns {import("./guard.mjs").Line[]}
 */
const linesOf = (results) =>
  results.map(({ row, name, strict, loose, errors }) => ({
    ...{ row, case: name, strict: strict === true, loose: loose === true },
    errors: errors?.map((error) => (error === null ? null : rounded(error))) ?? null,
  }));
