/** Console output, which suites that run side by side print one after the other. */
import { AsyncLocalStorage } from "node:async_hooks";

/** Output of the suite that the caller runs in, where suites run side by side. @type {AsyncLocalStorage<string[]>} */
const collecting = new AsyncLocalStorage();

/** @param {string} text */
export function print(text) {
  const collected = collecting.getStore();
  if (collected) collected.push(text);
  else process.stdout.write(text);
}

/** Whether what is printed now is seen now. */
export const isLive = () => collecting.getStore() === undefined;

/**
 * Runs an action and returns its result with everything that it printed.
 * @template T
 * @param {() => Promise<T>} action
 * @returns {Promise<{ result: T, output: string }>}
 */
export async function collect(action) {
  /** @type {string[]} */
  const collected = [];
  const result = await collecting.run(collected, action);
  return { result, output: collected.join("") };
}
