/** Steps, checks and errors of the commands, and what they print. */
import { isLive, print } from "./output.mjs";
import { CommandError } from "./run.mjs";

/** @typedef {import("./counts.mjs").Counts} Counts */
/** @typedef {(note: string) => void} Say sets the note at the end of a step's line */

/** @param {number} milliseconds */
export function duration(milliseconds) {
  const seconds = milliseconds / 1000;
  if (seconds < 59.95) return `${seconds.toFixed(1)} s`;
  return `${Math.floor(Math.round(seconds) / 60)} min ${Math.round(seconds) % 60} s`;
}

/**
 * Runs an action and prints one line about it: title, note, time. Steps may run side by side.
 * @template T
 * @param {string} title
 * @param {(say: Say) => T | Promise<T>} action
 * @returns {Promise<T>}
 */
export async function step(title, action) {
  const started = performance.now();
  let note = "done";
  // Shows what takes its time.
  const announcement = setTimeout(() => isLive() && print(`${title} …\n`), 2000);
  const end = (/** @type {string} */ outcome) => {
    clearTimeout(announcement);
    print(`${title}: ${outcome} (${duration(performance.now() - started)})\n`);
  };
  try {
    const result = await action((text) => {
      note = text;
    });
    end(note);
    return result;
  } catch (error) {
    end("FAILED");
    throw error;
  }
}

/**
 * Runs checks, each of which counts as one test. A failing check does not stop the others.
 * @param {readonly (readonly [title: string, check: (say: Say) => unknown])[]} checks
 * @returns {Promise<Counts>}
 */
export async function runChecks(checks) {
  let failed = 0;
  for (const [name, check] of checks) {
    try {
      await step(name, check);
    } catch (error) {
      failed += 1;
      explain(error);
    }
  }
  return { passed: checks.length - failed, failed, skipped: 0 };
}

/**
 * Prints an error: of a command, its output and the remedy; of our own, the message.
 * @param {unknown} error
 */
export function explain(error) {
  if (error instanceof CommandError) {
    print(`\n${error.output.trimEnd()}\n\n${error.message}\n${error.remedy ? `Remedy: ${error.remedy}\n` : ""}`);
  } else if (error instanceof Error) print(`${error.name === "Error" ? error.message : error.stack}\n`);
  else print(`${error}\n`);
}

/**
 * Runs a script's main function. A failure is printed and ends the process with status 1.
 * @param {() => Promise<void>} main
 */
export async function script(main) {
  try {
    await main();
  } catch (error) {
    explain(error);
    process.exitCode = 1;
  }
}
