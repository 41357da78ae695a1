/** `npm run interop`: real programs write what our readers read, and load what we write; see `--help`. */
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { command } from "./bench/command.mjs";
import { data, factsOf, filesOf, root, runPackage, withFound } from "./interop/cells.mjs";
import { writeFixtures, writePlaces, writeTable } from "./interop/table.mjs";
import { cached, digest } from "./lib/cache.mjs";
import { buildPackage } from "./lib/package.mjs";
import { at } from "./lib/paths.mjs";
import { pythonOf } from "./lib/python.mjs";
import { attempt, run } from "./lib/run.mjs";
import { step } from "./lib/step.mjs";

/**
 * @typedef {import("./interop/cells.mjs").Written} Written
 * @typedef {import("./interop/cells.mjs").Row} Row
 * @typedef {import("./interop/cells.mjs").Done} Done
 */

const env = {
  PYTHONPATH: at("scripts"),
  PYTHONDONTWRITEBYTECODE: "1",
  // Without it, OpenCV 4 writes no EXR.
  OPENCV_IO_ENABLE_OPENEXR: "1",
};
/**
 * Of each environment of Python, the packages of its programs, the first in the version that is run, and what they need `also`.
 * @type {{ python: Record<string, Record<string, string>>, npm: string[] }}
 */
const packages = data("packages");

/** Installs npm packages that the repository does not have. */
async function npm() {
  const folder = join(root, "npm");
  const install = ["install", "--prefix", folder, "--ignore-scripts", "--no-audit", "--no-fund", ...packages.npm];
  const remedy = "check that the npm registry can be reached";
  await cached(join(folder, "installed-from"), digest([], packages.npm), [], async () => {
    await run("npm", install, { remedy });
  });
}

/**
 * Runs a Python program. What crashes misses all of its cells.
 * @param {string} python
 * @param {string} name
 * @param {readonly Written[]} files
 * @param {readonly Row[]} facts
 * @returns {Promise<Done>}
 */
async function runPython(python, name, files, facts) {
  const job = join(root, "rows", "job.json");
  const calls = facts.filter(({ call }) => call.length > 0).map(({ kind, name, call }) => [kind, name, ...call]);
  const writes = Object.fromEntries(files.map(({ file, call }) => [file, call]));
  writeFileSync(job, JSON.stringify({ writes, facts: calls }));
  const { reason, output } = await attempt(python, ["-m", "interop", "cells.run", root, name, job], { env });
  if (reason === "") return JSON.parse(readFileSync(job, "utf8"));
  return { failed: {}, found: {}, why: `${reason} ${output.slice(-300)}` };
}

/** @param {{ only?: string[], write: boolean, verbose: boolean, python: string }} options */
async function interop({ only, write, verbose, python: program }) {
  if (write && only !== undefined) throw new Error("--write: some programs are not the whole table; leave out --only.");
  await buildPackage();
  await step("npm packages", npm);
  const { readBack } = await import("./interop/read.mjs");
  const { writeOurs } = await import("./interop/ours.mjs");
  const { packageOf, programs } = await import("./interop/programs.mjs");

  /** @type {Record<string, Promise<string>>} */
  const installed = {};
  /** The Python of an environment. @param {string} name */
  const pythonIn = (name) => {
    const list = [...new Set(Object.values(packages.python[name] ?? {}).flatMap((each) => each.split(" ")))];
    const install = () => pythonOf(join(root, name), digest([], list), list, program);
    installed[name] ??= step(`Python packages: ${name}`, install);
    return installed[name];
  };
  /** @type {{ name: string, version: string, does: (files: Written[], facts: Row[]) => Promise<Done> }[]} */
  const all = [];
  for (const [environment, { also, ...versions }] of Object.entries(packages.python)) {
    for (const [name, requirements] of Object.entries(versions)) {
      const version = /==(\S+)/.exec(requirements)?.[1] ?? "";
      all.push({ name, version, does: async (...rows) => runPython(await pythonIn(environment), name, ...rows) });
    }
  }
  for (const [name, { from, open }] of Object.entries(programs)) {
    all.push({ name, version: packageOf(from).version, does: (...rows) => runPackage(() => open(from), ...rows) });
  }
  const isAsked = (/** @type {{ name: string }} */ { name }) => only === undefined || only.includes(name);
  const unknown = only?.find((name) => !all.some((each) => each.name === name));
  if (unknown !== undefined) throw new Error(`--only: no program is called ${unknown}.`);

  rmSync(join(root, "files"), { recursive: true, force: true });
  mkdirSync(join(root, "rows"), { recursive: true });
  const main = await pythonIn("main");
  await run(main, ["-m", "interop", "truth.write", root], { env });
  await writeOurs(join(root, "ours"), join(root, "truth"));

  // Of programs that were not asked for, only the files that others convert.
  const needed = all.filter(isAsked).flatMap(({ name, version }) => filesOf(name, version).flatMap(({ call }) => call));
  /** @type {any[]} */
  const rows = [];
  for (const each of all) {
    const { name, version, does } = each;
    const files = filesOf(name, version).filter(({ file }) => isAsked(each) || needed.includes(file));
    const facts = isAsked(each) ? factsOf(name, version) : [];
    if (files.length + facts.length === 0) continue;
    await step(`${name} ${version}`, async (say) => {
      const own = await withFound(files, facts, await does(files, facts), readBack);
      if (isAsked(each)) rows.push(...own);
      say(isAsked(each) ? `${own.length} cells` : `${own.length} files for others`);
    });
  }

  const file = join(root, "rows", "all.json");
  writeFileSync(file, JSON.stringify(rows));
  await run(main, ["-m", "interop", "checks.check", root, file], { env });
  /** @type {import("./interop/table.mjs").Cell[]} */
  const cells = JSON.parse(readFileSync(file, "utf8"));
  const misses = cells.filter(({ passed }) => !passed);
  for (const { program, version, kind, variant, result, passed } of verbose ? cells : misses) {
    console.log(`${passed ? "as stated" : "MISS"}: ${program} ${version}, ${kind}, ${variant}: ${result}`);
  }
  console.log(`${cells.length} cells, ${misses.length} misses.`);
  if (write) {
    writePlaces(cells);
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
    .option("--write", "write the tables of docs/guides/interoperability.md, without --only", false)
    .option("--verbose", "print every cell", false)
    .option("--python <program>", "the Python (3.11) that installs the packages", "python3")
    .action(interop),
);
