/** Suites of simple checks, of which each counts as one test. */
import { explain, step } from "../lib/step.mjs";

/**
 * Makes all checks; a failing one is explained and does not stop the others.
 * @param {readonly (readonly [title: string, check: (say: (note: string) => void) => unknown])[]} checks
 * @returns {Promise<import("../lib/counts.mjs").Counts>}
 */
export async function runChecks(checks) {
  let failed = 0;
  for (const [title, check] of checks) {
    try {
      await step(title, check);
    } catch (error) {
      failed += 1;
      explain(error);
    }
  }
  return { passed: checks.length - failed, failed, skipped: 0 };
}
