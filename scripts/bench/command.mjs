/** Command lines. */
import { existsSync } from "node:fs";
import { at } from "../lib/paths.mjs";
import { setUp } from "../lib/setup.mjs";
import { script } from "../lib/step.mjs";

/** @typedef {import("commander").Command} Command */

/**
 * Runs an `npm run` command. What parses its arguments is an npm package, which a fresh clone has to install first.
 * @param {string} name
 * @param {(command: Command) => Command} configure sets description, arguments, options and action
 */
export function command(name, configure) {
  return script(async () => {
    if (!existsSync(at("node_modules", "commander"))) await setUp();
    const { Command } = await import("commander");
    await configure(new Command(`npm run ${name} --`).showHelpAfterError()).parseAsync();
  });
}

/**
 * Reads a whole number from 1.
 * @param {string} text
 */
export function count(text) {
  const number = Number(text);
  if (Number.isSafeInteger(number) && number >= 1) return number;
  // By this code commander knows that the argument is to blame, and names it.
  throw Object.assign(new Error("Expected a whole number from 1."), { code: "commander.invalidArgument" });
}

/**
 * The options of commands that run `sim3align-bench` over the generated set, or read what it kept.
 * @param {Command} program
 * @param {string} json where everything is kept by default
 */
export const setOptions = (program, json) =>
  program
    .option("--cases <n>", "generated cases", count, 240)
    .option("--set-seed <s>", "seed of the generated set", Number, 0)
    .option("--meshes <dir>", "show the GLB files of a folder in a third of the cases")
    .option("--threads <n>", "all by default", count)
    .option("--json <file>", "keep everything about every case here", json)
    .option("--from <file>", "run nothing, and read what an earlier run has kept");
