/** Numbers of tests, as our own suites count them and as other programs print them. */

/** @typedef {{ passed: number, failed: number, skipped: number }} Counts */

/** @returns {Counts} */
export const noTests = () => ({ passed: 0, failed: 0, skipped: 0 });

/** @param {readonly Counts[]} counts @returns {Counts} */
export const sum = (counts) =>
  counts.reduce(
    (total, { passed, failed, skipped }) => ({
      passed: total.passed + passed,
      failed: total.failed + failed,
      skipped: total.skipped + skipped,
    }),
    noTests(),
  );

/** The output without colours. @param {string} output */
// biome-ignore lint/suspicious/noControlCharactersInRegex: colours are control characters.
const plain = (output) => output.replace(/\u001b\[[0-9;]*m/g, "");

/**
 * The sum of the result lines of `cargo test` and wasm-bindgen-test, which have the same form.
 * @param {string} output
 */
export function rustCounts(output) {
  const results = plain(output).matchAll(/test result: \w+\. (\d+) passed; (\d+) failed; (\d+) ignored/g);
  return sum(
    Array.from(results, ([, passed, failed, skipped]) => ({
      passed: Number(passed),
      failed: Number(failed),
      skipped: Number(skipped),
    })),
  );
}

/**
 * The summary of `node --test` in its `spec` form.
 * @param {string} output
 * @returns {Counts}
 */
export function nodeCounts(output) {
  const text = plain(output);
  const number = (/** @type {string} */ name) => Number(new RegExp(`^ℹ ${name} (\\d+)$`, "m").exec(text)?.[1] ?? 0);
  const failed = number("fail") + number("cancelled");
  return { passed: number("pass"), failed, skipped: number("skipped") + number("todo") };
}

/**
 * The files of tests that `node --test` ended, because they took too long.
 * @param {string} output
 */
export const hungFiles = (output) => [
  ...new Set(
    Array.from(plain(output).matchAll(/^✖ (\S+\.test\.js) \(.*\)\n +'test timed out/gm), ([, file = ""]) => file),
  ),
];

/**
 * A test program that ended badly has failed, even where it counted no failure (it did not compile, or crashed).
 * @param {Counts} counts
 * @param {boolean} succeeded
 * @returns {Counts}
 */
export const withStatus = (counts, succeeded) =>
  succeeded || counts.failed > 0 ? counts : { ...counts, failed: counts.failed + 1 };
