/**
 * `npm run record`: what this version is worth, as one file: every set of `sets.mjs`, each case with its errors, confidence
 * and time. An interrupted run is resumed. `--quick` takes a part of each set, of which the repository keeps the last one;
 * `--check` compares with that, and fails if anything has become worse.
 */
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { environment } from "../bench/results.mjs";
import { fixed, markdownTable, percent } from "../bench/table.mjs";
import { digest } from "../lib/cache.mjs";
import { runLab, runTestedLab } from "../lib/lab.mjs";
import { packageVersion } from "../lib/package.mjs";
import { at } from "../lib/paths.mjs";
import { step } from "../lib/step.mjs";
import { sizes, wasmFile, wasmModules } from "../lib/wasm.mjs";
import { losses } from "./guard.mjs";
import { extendHistory } from "./history.mjs";
import { argsOf, givenSet, linesOf, sets } from "./sets.mjs";
import { summaries } from "./summary.mjs";

/** The quick record that changes are compared with. */
const quickFile = at("docs", "record", "quick.json");

/**
 * @typedef {object} RecordOptions
 * @property {boolean} [quick]
 * @property {boolean} [check]
 * @property {boolean} [save]
 * @property {string} [out]
 * @property {boolean} [fresh]
 * @property {boolean} [tested]
 * @property {number} [threads]
 */

/** @param {RecordOptions} options */
export async function record({ quick = false, check, save, out, fresh = false, tested, threads }) {
  const version = packageVersion();
  const given = quick ? undefined : process.env.SIM3ALIGN_CASES;
  const sources = ["src", "geometry", "formats", "lab", "Cargo.toml", "Cargo.lock", "scripts/record/sets.mjs"];
  const code = digest(
    sources.map((name) => at(name)),
    given === undefined ? [] : [given],
  );
  // Results of other code, or of other cases, stay, and are not taken for those of this one.
  const folder = resolve(out ?? at("target", "bench", "record"), `${quick ? "quick" : "whole"}-${code.slice(0, 12)}`);
  if (fresh) rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  const all = given === undefined ? sets : [...sets, givenSet(given)];
  const found = [];
  for (const set of all) {
    const file = join(folder, `${set.name}.json`);
    await step(set.title, async (say) => {
      if (existsSync(file)) return say("done before");
      const args = [...argsOf(set, quick), "--json", file];
      if (threads !== undefined) args.push("--threads", `${threads}`);
      await (tested ? runTestedLab : runLab)(args, { echo: "errors" });
    });
    found.push({ set: set.name, lines: linesOf(set, file) });
  }
  const rows = found.flatMap(({ set, lines }) => summaries(set, lines));
  console.log(`\n${tableOf(rows)}\n`);
  const measured = Object.fromEntries(
    wasmModules
      .filter((module) => existsSync(wasmFile(module)))
      .map((module) => [module.name, sizes(wasmFile(module)).gzip]),
  );
  const whole = { version, ...(await environment()), sizes: measured, sets: found };
  writeFileSync(join(folder, "record.json"), JSON.stringify(whole));
  console.log(`The record is ${join(folder, "record.json")}.`);
  if (save) keep(quick, whole, rows);
  return check ? losses(JSON.parse(readFileSync(quickFile, "utf8")), whole) : [];
}

/**
 * Writes what the repository keeps: the quick record case by case, of the whole one a line for each row.
 * @param {boolean} quick
 * @param {import("./guard.mjs").QuickRecord & import("./history.mjs").Run} whole
 * @param {readonly import("./summary.mjs").Summary[]} rows
 */
function keep(quick, { sizes: measured, sets: found, ...run }, rows) {
  mkdirSync(at("docs", "record"), { recursive: true });
  if (!quick) return extendHistory(run, measured, rows, found);
  // Times differ from run to run; everything else is the same bits.
  const timeless = found.map(({ set, lines }) => ({ set, lines: lines.map(({ ms: _, ...line }) => line) }));
  const text = JSON.stringify({ version: run.version, sizes: measured, sets: timeless });
  writeFileSync(quickFile, `${text.replaceAll('},{"row"', '},\n{"row"')}\n`);
}

/** @param {readonly import("./summary.mjs").Summary[]} rows */
function tableOf(rows) {
  const head = ["set", "row", "n", "strict %", "loose %", "scale %", "rotation °", "place %", "≥ .9: right of", "ms"];
  const cells = rows.map(({ set, row, n, strict, loose, medians: [scale, rotation, place], bins, ms }) => {
    const [sure, right] = bins.at(-1) ?? [0, 0];
    const share = (/** @type {number | null | undefined} */ value) =>
      fixed(value === null || value === undefined ? value : 100 * value, 2);
    const counts = bins.length > 0 ? `${right} of ${sure}` : "–";
    return [
      set,
      row,
      n,
      percent(strict),
      percent(loose),
      share(scale),
      fixed(rotation, 2),
      share(place),
      counts,
      fixed(ms),
    ];
  });
  return markdownTable(head, cells);
}
