/** Numbers of tests, as our own suites count them and as other programs print them. */

/** @typedef {{ passed: number, failed: number, skipped: number }} Counts */

/** @returns {Counts} */
export const noTests = () => ({ passed: 0, failed: 0, skipped: 0 });

/**
 * @param {Counts} a
 * @param {Counts} b
 * @returns {Counts}
 */
export const sum = (a, b) => ({
  passed: a.passed + b.passed,
  failed: a.failed + b.failed,
  skipped: a.skipped + b.skipped,
});

/** @param {string} output */
function plain(output) {
  // biome-ignore lint/suspicious/noControlCharactersInRegex: colours are control characters.
  return output.replace(/\u001b\[[0-9;]*m/g, "");
}

/**
 * The sum of the result lines of `cargo test` and wasm-bindgen-test, which are worded alike.
 * @param {string} output
 * @returns {Counts}
 */
export function rustCounts(output) {
  const results = plain(output).matchAll(/test result: \w+\. (\d+) passed; (\d+) failed; (\d+) ignored/g);
  return [...results]
    .map(([, passed, failed, skipped]) => ({
      passed: Number(passed),
      failed: Number(failed),
      skipped: Number(skipped),
    }))
    .reduce(sum, noTests());
}

/**
 * The summary of `node --test` in its `spec` form.
 * @param {string} output
 * @returns {Counts}
 */
export function nodeCounts(output) {
  const text = plain(output);
  const number = (/** @type {string} */ name) => Number(new RegExp(`^ℹ ${name} (\\d+)$`, "m").exec(text)?.[1] ?? 0);
  return {
    passed: number("pass"),
    failed: number("fail") + number("cancelled"),
    skipped: number("skipped") + number("todo"),
  };
}

/**
 * A test program that ended badly has failed, even where it counted no failure (it did not compile, or crashed).
 * @param {Counts} counts
 * @param {boolean} succeeded
 * @returns {Counts}
 */
export const withStatus = (counts, succeeded) =>
  succeeded || counts.failed > 0 ? counts : { ...counts, failed: counts.failed + 1 };
