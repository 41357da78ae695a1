/** The cells of the matrix: what `writes.json` and `loads.json` state for a program, and what came of it. */
import { mkdirSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { at } from "../lib/paths.mjs";

export const root = at("target", "interop");
export const data = (/** @type {string} */ name) =>
  JSON.parse(readFileSync(at("scripts", "interop", `${name}.json`), "utf8"));

const { expectations, files } = data("writes");
const loads = data("loads");
const places = data("places");

/**
 * A cell, or what will be one: a file with the call that writes it, or a fact that a program finds; `expect` is explained in `checks.py`.
 * @typedef {{ program: string, version: string, action: string, kind: string, variant: string, expect?: any, found?: any, passed?: boolean, result?: string, error?: number, unit?: string }} Cell
 * @typedef {Cell & { of: string, file: string, call: any[] }} Written
 * @typedef {{ failed: Record<string, string>, found: Record<string, Record<string, any>>, why: string }} Done
 */

/** The entries of a table for a program, for all of its versions or for this one. @param {any[]} entries @param {string} name @param {string} version */
const statedFor = (entries, name, version) =>
  entries.filter(({ programs }) => programs.includes(name) || programs.includes(`${name} ${version}`));

/** The names of a cell. @param {string} program @param {string} version @param {string} action @param {string} of @param {string} variant */
const named = (program, version, action, of, variant) =>
  places[of] === undefined
    ? { program, version, action, kind: of, variant, of }
    : { program, version, action: "place", kind: places[of].question, variant, of };

/** The files that a program should write. @param {string} program @param {string} version @returns {Written[]} */
export function filesOf(program, version) {
  const folder = join(root, "files", `${program}-${version}`.replaceAll(" ", "-"));
  const rows = statedFor(files, program, version).flatMap(({ kind, each, rows }) => {
    const text = JSON.stringify(rows);
    const all = each?.flatMap((/** @type {string} */ word) => JSON.parse(text.replaceAll("{}", word))) ?? rows;
    return all.map((/** @type {any[]} */ row) => [kind, ...row]);
  });
  return rows.map(([kind, variant, file, expect, writer, ...args], i) => {
    const options = args.at(-1)?.options === undefined ? {} : args.pop().options;
    const limits = [expect].flat().map((each) => (typeof each === "string" ? expectations[each] : each));
    return {
      ...named(program, version, "write", kind, variant),
      file: join(folder, `${i}-${variant.replace(/\W+/g, "-")}`, file),
      call: [writer, options, ...args],
      expect: Object.assign({}, ...limits),
    };
  });
}

/** The facts that a program should find in our files. @param {string} program @param {string} version */
const factsOf = (program, version) =>
  statedFor(loads, program, version).flatMap(({ of, facts }) =>
    Object.entries(facts).map(([fact, { variant, ...expect }]) => ({
      ...named(program, version, "load", of, variant),
      fact,
      expect,
    })),
  );

/** The path of a file by its program, version and variant: `trimesh 5.2.0: dae`. @param {string} title */
export function fileOf(title) {
  const [, program = "", version = "", variant] = /^(.+?) (\S+): (.+)$/.exec(title) ?? [];
  const row = filesOf(program, version).find((each) => each.variant === variant);
  if (row === undefined) throw new Error(`no program writes ${title}`);
  return row;
}

/**
 * All rows of a program, for `checks.py`.
 * @param {string} program
 * @param {string} version
 * @param {(files: Written[]) => Promise<Done>} run
 * @param {(row: Written) => Promise<unknown>} read our reader
 */
export async function rowsOf(program, version, run, read) {
  const written = filesOf(program, version);
  const { failed, found, why } = await run(written);
  const missed = (/** @type {string} */ result) => ({ passed: false, result });
  const rows = [];
  for (const row of written) {
    const reason = failed[row.file];
    rows.push({ ...row, ...(reason === undefined ? { found: await read(row) } : missed(`not written: ${reason}`)) });
  }
  for (const row of factsOf(program, version)) {
    const value = found[row.of]?.[row.fact];
    rows.push({ ...row, ...(value === undefined ? missed(`not loaded: ${why}`) : { found: value }) });
  }
  return rows;
}

/**
 * The calls with which an npm program fills its cells; `cells.py` has those of Python programs.
 * @typedef {object} Cells
 * @property {(writers: Record<string, (path: string, options: any, ...args: any[]) => unknown>) => Promise<void>} writes
 * @property {(load: (path: string) => Promise<Iterable<number>>) => Promise<void>} glb
 */

/** Runs an npm program. @param {(cells: Cells) => Promise<void>} run @param {readonly Written[]} files @returns {Promise<Done>} */
export async function runPackage(run, files) {
  const done = { failed: Object.fromEntries(files.map(({ file }) => [file, ""])), found: { GLB: {} }, why: "" };
  /** @type {Cells} */
  const cells = {
    async writes(writers) {
      for (const { file, call } of files) {
        const [name, options, ...args] = call;
        mkdirSync(dirname(file), { recursive: true });
        try {
          await writers[name]?.(file, options, ...args);
          delete done.failed[file];
        } catch (error) {
          const { message, stderr } = /** @type {any} */ (error);
          done.failed[file] = `${stderr || message}`.slice(0, 300);
        }
      }
    },
    async glb(load) {
      for (const name of ["node", "baked", "textured", "scene-camera", "node-opencv"]) {
        Object.assign(done.found.GLB, { [name]: [...(await load(join(root, "ours", `${name}.glb`)))] });
      }
    },
  };
  await run(cells).catch((error) => {
    done.why = `${error}`;
  });
  return done;
}
