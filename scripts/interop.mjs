/** `npm run interop`: real programs write what our readers read, and load what we write; see `--help`. */
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { command } from "./bench/command.mjs";
import { data, root, rowsOf, runPackage } from "./interop/cells.mjs";
import { writeFixtures, writePlaces, writeTable } from "./interop/table.mjs";
import { cached, digest } from "./lib/cache.mjs";
import { buildPackage } from "./lib/package.mjs";
import { at } from "./lib/paths.mjs";
import { pythonOf } from "./lib/python.mjs";
import { attempt, run } from "./lib/run.mjs";
import { step } from "./lib/step.mjs";

/** @typedef {import("./interop/table.mjs").Cell} Cell */

const env = { PYTHONPATH: at("scripts"), PYTHONDONTWRITEBYTECODE: "1" };
/**
 * Of each environment of Python, the packages of its programs, the first in the version that is run, and what they need `also`.
 * @type {{ python: Record<string, Record<string, string>>, npm: Record<string, string> }}
 */
const packages = data("packages");

/** Installs npm packages that the repository does not have. */
async function npm() {
  const folder = join(root, "npm");
  const wanted = JSON.stringify({ private: true, dependencies: packages.npm }, null, 2);
  await cached(join(folder, "installed-from"), digest([], [wanted]), [], async () => {
    mkdirSync(folder, { recursive: true });
    writeFileSync(join(folder, "package.json"), wanted);
    await run("npm", ["install", "--ignore-scripts", "--no-audit", "--no-fund"], {
      cwd: folder,
      remedy: "check that the npm registry can be reached",
    });
  });
}

/**
 * Runs a Python program.
 * @param {string} python
 * @param {string} name
 * @param {string} version
 * @param {readonly import("./interop/cells.mjs").Written[]} files
 */
async function runPython(python, name, version, files) {
  const job = join(root, "rows", `${name}-${version}.json`);
  const writes = Object.fromEntries(files.map(({ file, call }) => [file, call]));
  writeFileSync(job, JSON.stringify({ version, writes }));
  const { reason, output } = await attempt(python, ["-m", "interop", "cells.run", root, name, job], { env });
  if (reason === "") return JSON.parse(readFileSync(job, "utf8"));
  // What crashes misses all of its cells.
  const why = `${reason} ${output.slice(-300)}`;
  return { failed: Object.fromEntries(files.map(({ file }) => [file, why])), found: {}, why };
}

/** @param {{ only?: string[], write: boolean, verbose: boolean, python: string }} options */
async function interop({ only, write, verbose, python: program }) {
  await buildPackage();
  const { readBack } = await import("./interop/read.mjs");
  const { writeOurs } = await import("./interop/ours.mjs");
  const { packageOf, programs } = await import("./interop/programs.mjs");
  const ofPython = Object.values(packages.python).flatMap(({ also, ...versions }) => Object.keys(versions));
  const unknown = only?.find((name) => ![...ofPython, ...Object.keys(programs)].includes(name));
  if (unknown !== undefined) throw new Error(`--only: no program is called ${unknown}.`);
  rmSync(join(root, "files"), { recursive: true, force: true });
  mkdirSync(join(root, "rows"), { recursive: true });

  const pythonIn = (/** @type {string} */ name) => {
    const list = [...new Set(Object.values(packages.python[name] ?? {}).flatMap((each) => each.split(" ")))];
    return step(`Python packages: ${name}`, () => pythonOf(join(root, name), digest([], list), list, program));
  };
  const main = await pythonIn("main");
  await run(main, ["-m", "interop", "truth.write", root], { env });
  await writeOurs(join(root, "ours"), join(root, "truth"));

  /** @type {any[]} */
  const rows = [];
  /** @typedef {Parameters<typeof rowsOf>[2]} Run */
  const add = (/** @type {string} */ name, /** @type {string} */ version, /** @type {Run} */ does) =>
    step(`${name} ${version}`, async (say) => {
      const own = await rowsOf(name, version, does, readBack);
      rows.push(...own);
      say(`${own.length} cells`);
    });
  const isWanted = (/** @type {string} */ name) => only === undefined || only.includes(name);
  for (const [environment, { also, ...versions }] of Object.entries(packages.python)) {
    const wanted = Object.entries(versions).filter(([name]) => isWanted(name));
    if (wanted.length === 0) continue;
    const python = await pythonIn(environment);
    for (const [name, requirements] of wanted) {
      const version = /==(\S+)/.exec(requirements)?.[1] ?? "";
      await add(name, version, (files) => runPython(python, name, version, files));
    }
  }
  await step("npm packages", npm);
  for (const [name, { package: from, run: does }] of Object.entries(programs)) {
    if (isWanted(name))
      await add(name, packageOf(from).version, (files) => runPackage((cells) => does(cells, from), files));
  }

  const file = join(root, "rows", "all.json");
  writeFileSync(file, JSON.stringify(rows));
  await run(main, ["-m", "interop", "checks.check", root, file], { env });
  /** @type {Cell[]} */
  const cells = JSON.parse(readFileSync(file, "utf8"));
  const misses = cells.filter(({ passed }) => !passed);
  for (const { program, version, kind, variant, result, passed } of verbose ? cells : misses) {
    console.log(`${passed ? "as stated" : "MISS"}: ${program} ${version}, ${kind}, ${variant}: ${result}`);
  }
  console.log(`${cells.length} cells, ${misses.length} misses.`);
  if (write) writePlaces(cells);
  // Some programs are not the whole table.
  if (write && only === undefined) {
    writeFixtures(rows);
    writeTable(cells, new Date().toISOString().slice(0, 10));
  }
  if (misses.length > 0) process.exitCode = 1;
}

await command("interop", (program) =>
  program
    .description(
      "Runs some forty programs: our readers read what they write, and they load what we write. Takes about ten minutes, the first time more.",
    )
    .option("--only <program...>", "some programs, by their names in packages.json and programs.mjs of scripts/interop")
    .option("--write", "write the tables of docs/guides/interoperability.md; with --only, that of places", false)
    .option("--verbose", "print every cell", false)
    .option("--python <program>", "the Python (3.11) that installs the packages", "python3")
    .action(interop),
);
