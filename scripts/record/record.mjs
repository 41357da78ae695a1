/**
 * `npm run record`: what this version is worth, as one file: every set of `sets.mjs`, each case with its errors, confidence
 * and time. An interrupted run is resumed. `--quick` takes a part of each set, of which the repository keeps the last one;
 * `--check` compares with that, and fails if anything has become worse.
 */
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { environment } from "../bench/results.mjs";
import { markdownTable } from "../bench/table.mjs";
import { digest } from "../lib/cache.mjs";
import { runLab, runTestedLab } from "../lib/lab.mjs";
import { packageVersion } from "../lib/package.mjs";
import { at } from "../lib/paths.mjs";
import { step } from "../lib/step.mjs";
import { sizes, wasmFile, wasmModules } from "../lib/wasm.mjs";
import { cellsOf, head } from "./columns.mjs";
import { losses } from "./guard.mjs";
import { extendHistory } from "./history.mjs";
import { measureMemory, peerVersions } from "./inputs.mjs";
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
 * @property {readonly string[]} [only] sets, for a look at them
 * @property {boolean} [tested]
 * @property {number} [threads]
 */

/** @param {RecordOptions} options */
export async function record({ quick = false, check, save, out, fresh = false, only, tested, threads }) {
  if (only !== undefined && (save || check)) {
    throw new Error("Found --only with --save or --check. Remedy: leave it out; a record is whole.");
  }
  const version = packageVersion();
  const given = quick ? undefined : process.env.SIM3ALIGN_CASES;
  const sources = ["src", "geometry", "formats", "lab", "Cargo.toml", "Cargo.lock", "scripts/record/sets.mjs"];
  sources.push("scripts/bench/peers");
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
  for (const set of all.filter(({ name, cases }) => (!quick || cases[1] > 0) && (only?.includes(name) ?? true))) {
    const file = join(folder, `${set.name}.json`);
    await step(set.title, async (say) => {
      if (existsSync(file)) return say("done before");
      const prepared = await set.prepare?.(join(folder, set.name));
      if (typeof prepared === "string") return say(`left out: ${prepared}`);
      const args = [...argsOf(set, quick), ...(prepared ?? []), "--json", file];
      if (threads !== undefined) args.push("--threads", `${threads}`);
      await (tested ? runTestedLab : runLab)(args, { echo: "errors" });
    });
    if (existsSync(file)) found.push({ set: set.name, lines: linesOf(set, file) });
  }
  const rows = found.flatMap(({ set, lines }) => summaries(set, lines));
  console.log(`\n${tableOf(rows)}\n`);
  const measured = Object.fromEntries(
    wasmModules
      .filter((module) => existsSync(wasmFile(module)))
      .map((module) => [module.name, sizes(wasmFile(module)).gzip]),
  );
  const peers = peerVersions(join(folder, "peers"));
  const whole = {
    version,
    ...(await environment()),
    peers,
    memory: await memoryIn(folder, quick || only !== undefined),
    sizes: measured,
    sets: found,
  };
  writeFileSync(join(folder, "record.json"), JSON.stringify(whole));
  console.log(`The record is ${join(folder, "record.json")}.`);
  if (save) keep(quick, whole, rows);
  return check ? losses(JSON.parse(readFileSync(quickFile, "utf8")), whole) : [];
}

/**
 * The peaks of memory, measured once; none for a part of a record.
 * @param {string} folder
 * @param {boolean} isPart
 * @returns {Promise<NonNullable<import("./history.mjs").Run["memory"]>>}
 */
async function memoryIn(folder, isPart) {
  if (isPart) return [];
  const file = join(folder, "memory.json");
  await step("memory in WebAssembly", async (say) => {
    if (existsSync(file)) return say("done before");
    const reason = await measureMemory(file);
    say(reason || "within its limits");
  });
  return existsSync(file) ? JSON.parse(readFileSync(file, "utf8")) : [];
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
const tableOf = (rows) =>
  markdownTable(
    ["set", ...head],
    rows.map((row) => [row.set, ...cellsOf(row)]),
  );
