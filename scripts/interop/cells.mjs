/** The cells of the matrix: what `writes.json` and `loads.json` state for a program, and what came of it. */
import { existsSync, mkdirSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { at } from "../lib/paths.mjs";

export const root = at("target", "interop");
export const data = (/** @type {string} */ name) =>
  JSON.parse(readFileSync(at("scripts", "interop", `${name}.json`), "utf8"));

const { defaults, expectations, files } = data("writes");
const facts = data("loads");
const places = data("places");

/**
 * A row of a table: the file that a program writes by a call, or the name of a fact that it finds; `expect` is explained in `checks.py`.
 * @typedef {{ program: string, version: string, action: string, kind: string, variant: string, name: string, call: any[], expect: any }} Row
 * @typedef {Row & { file: string }} Written
 * @typedef {Row & { passed: boolean, result: string, error?: number, unit?: string }} Cell
 * @typedef {{ failed: Record<string, string>, found: Record<string, Record<string, any>>, why: string }} Done
 */

/** The rows for a program, for all of its versions or for this one. @param {any[]} table @param {string} action @param {string} program @param {string} version @returns {Row[]} */
function statedFor(table, action, program, version) {
  const titles = [program, `${program} ${version}`];
  const entries = table.filter(({ programs }) => titles.some((title) => programs.includes(title)));
  return entries.flatMap(({ kind, each, rows }) => {
    const text = JSON.stringify(rows);
    const all = each?.flatMap((/** @type {string} */ word) => JSON.parse(text.replaceAll("{}", word))) ?? rows;
    return all.map((/** @type {any[]} */ [variant, name, expect, ...call]) => {
      const limits = [expect].flat().map((each) => (typeof each === "string" ? expectations[each] : each));
      const cell = { program, version, action: kind in places ? "place" : action, kind, variant };
      return { ...cell, name, call, expect: Object.assign({}, action === "write" && defaults[kind], ...limits) };
    });
  });
}

/** The files that a program should write. @param {string} program @param {string} version @returns {Written[]} */
export function filesOf(program, version) {
  const folder = join(root, "files", `${program}-${version}`.replaceAll(" ", "-"));
  return statedFor(files, "write", program, version).map((row, i) => ({
    ...row,
    file: join(folder, `${i}-${row.variant.replace(/\W+/g, "-")}`, row.name),
    // What another program wrote.
    call: row.call.map((each) => (each?.by === undefined ? each : fileOf(each))),
  }));
}

/** @param {{ by: string, version: string, variant: string }} source */
function fileOf({ by, version, variant }) {
  const row = filesOf(by, version).find((each) => each.variant === variant);
  if (row === undefined) throw new Error(`${by} ${version} writes no ${variant}`);
  return row.file;
}

/** The facts that a program should find in our files. @param {string} program @param {string} version */
export const factsOf = (program, version) => statedFor(facts, "load", program, version);

/**
 * The rows with what was found, for `checks.py`.
 * @param {readonly Written[]} files
 * @param {readonly Row[]} facts
 * @param {Done} done
 * @param {(row: Written) => Promise<unknown>} read our reader
 */
export async function withFound(files, facts, { failed, found, why }, read) {
  const rows = [];
  for (const row of files) {
    const reason = failed[row.file] ?? (existsSync(row.file) ? undefined : why);
    const end = reason === undefined ? { found: await read(row) } : { passed: false, result: `not written: ${reason}` };
    rows.push({ ...row, ...end });
  }
  for (const row of facts) {
    const value = found[row.kind]?.[row.name];
    rows.push({
      ...row,
      ...(value === undefined ? { passed: false, result: `not loaded: ${why}` } : { found: value }),
    });
  }
  return rows;
}

/**
 * An npm program: the functions that write its files, by their names in `writes.json`, and the one that reads positions from a GLB.
 * @typedef {object} Program
 * @property {Record<string, (path: string, ...args: any[]) => unknown>} writers
 * @property {(path: string) => Promise<Iterable<number>>} [glb]
 */

/** Runs an npm program; `cells.py` runs those of Python. @param {() => Promise<Program>} open @param {readonly Written[]} files @param {readonly Row[]} facts @returns {Promise<Done>} */
export async function runPackage(open, files, facts) {
  /** @type {Done} */
  const done = { failed: {}, found: { GLB: {} }, why: "the program did not do it" };
  try {
    const { writers, glb } = await open();
    for (const { file, call } of files) {
      const [name, ...args] = call;
      mkdirSync(dirname(file), { recursive: true });
      try {
        await writers[name]?.(file, ...args);
      } catch (error) {
        const { message, stderr } = /** @type {any} */ (error);
        done.failed[file] = `${stderr || message}`.slice(0, 300);
      }
    }
    for (const { kind, name } of facts) {
      Object.assign(done.found[kind] ?? {}, { [name]: [...((await glb?.(join(root, "ours", `${name}.glb`))) ?? [])] });
    }
  } catch (error) {
    done.why = `${error}`;
  }
  return done;
}
