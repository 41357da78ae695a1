/** Command lines. */
import { npmPackages } from "../lib/setup.mjs";
import { script } from "../lib/step.mjs";

/** @typedef {import("commander").Command} Command */

/**
 * Runs an `npm run` command. The parser of its arguments is an npm package, which a fresh clone has to install first.
 * @param {string} name
 * @param {(command: Command) => Command} configure sets description, arguments, options and action
 */
export function command(name, configure) {
  return script(async () => {
    await npmPackages();
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
