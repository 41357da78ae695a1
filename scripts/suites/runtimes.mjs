/** The package in runtimes other than Node: Deno and Bun, whose programs are npm packages. */
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { noTests } from "../lib/counts.mjs";
import { at, installDir } from "../lib/paths.mjs";
import { attempt, run } from "../lib/run.mjs";
import { step } from "../lib/step.mjs";
import { runChecks } from "./checks.mjs";
import { install } from "./package.mjs";

/** They are 400 MB, which nothing else needs: they are not among the repository's own packages. */
const versions = { bun: "1.4.5", deno: "2.9.6" };
const folder = at("target", "runtimes");
const program = (/** @type {string} */ name) => join(folder, "node_modules", ".bin", name);

/** Installs them where they are not; whether each runs. */
async function installed() {
  const runs = async (/** @type {string} */ name) => (await attempt(program(name), ["--version"])).reason === "";
  const present = async () => (await Promise.all(Object.keys(versions).map(runs))).every(Boolean);
  if (await present()) return true;
  mkdirSync(folder, { recursive: true });
  writeFileSync(join(folder, "package.json"), JSON.stringify({ private: true, dependencies: versions }));
  await step("install Deno and Bun", () => attempt("npm", ["install", "--no-audit", "--no-fund"], { cwd: folder }));
  return present();
}

/** What Deno and Bun make of the package is, to the bit, what Node makes of it. */
export async function runtimes() {
  if (!(await installed())) {
    console.log("Deno and Bun can't be installed here. Remedy: let npm install them and run their install scripts.");
    return { ...noTests(), ...(process.env.CI ? { failed: 1 } : { skipped: 1 }) };
  }
  await install();
  const script = join(installDir, "tests", "bundlers", "runtime.js");
  const expected = await run(process.execPath, [script], { cwd: installDir });
  const same = (/** @type {string} */ name, /** @type {readonly string[]} */ args) => async () => {
    const output = await run(program(name), [...args, script], { cwd: installDir });
    if (output.trim() !== expected.trim()) throw new Error(`${name} finds\n${output}\nwhere Node finds\n${expected}`);
  };
  return runChecks([
    ["Deno, allowed to read files", same("deno", ["run", "--no-lock", "--allow-read"])],
    ["Bun", same("bun", ["run"])],
  ]);
}
