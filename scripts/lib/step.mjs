/** Steps: one line each on the console, with the time they took. */
import { CommandError } from "./run.mjs";

/**
 * A duration for people.
 * @param {number} milliseconds
 */
export function duration(milliseconds) {
  const seconds = milliseconds / 1000;
  if (seconds < 60) return `${seconds.toFixed(1)} s`;
  return `${Math.floor(seconds / 60)} min ${Math.round(seconds % 60)} s`;
}

/**
 * Does one thing and says so in one line.
 * @template T
 * @param {string} title
 * @param {(say: (note: string) => void) => T | Promise<T>} action `say` sets the note that ends the line
 * @returns {Promise<T>}
 */
export async function step(title, action) {
  const started = performance.now();
  let note = "done";
  process.stdout.write(`${title} … `);
  try {
    const result = await action((text) => {
      note = text;
    });
    process.stdout.write(`${note} (${duration(performance.now() - started)})\n`);
    return result;
  } catch (error) {
    process.stdout.write(`FAILED (${duration(performance.now() - started)})\n`);
    throw error;
  }
}

/**
 * Shows an error: of a command, all it printed and the remedy; of our own, the message.
 * @param {unknown} error
 */
export function explain(error) {
  if (error instanceof CommandError) {
    console.error(`\n${error.output.trimEnd()}\n\n${error.message}`);
    if (error.remedy) console.error(`Remedy: ${error.remedy}`);
  } else {
    console.error(error instanceof Error && error.name === "Error" ? error.message : error);
  }
}

/**
 * Runs a script's main function; a failure is explained and ends the process with status 1.
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
