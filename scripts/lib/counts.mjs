/** Numbers and times of tests, as our own suites count them and as other programs print them. */

/** @typedef {{ name: string, ms: number }} Timed a test or a step, and how long it took */
/** @typedef {{ passed: number, failed: number, skipped: number, times?: readonly Timed[] }} Counts */

/** @returns {Counts} */
export const noTests = () => ({ passed: 0, failed: 0, skipped: 0 });

/** @param {readonly Counts[]} counts @returns {Counts & { times: Timed[] }} */
export function sum(counts) {
  const of = (/** @type {"passed" | "failed" | "skipped"} */ name) =>
    counts.reduce((total, one) => total + one[name], 0);
  return {
    passed: of("passed"),
    failed: of("failed"),
    skipped: of("skipped"),
    times: counts.flatMap(({ times = [] }) => times),
  };
}

/** The output without colours. @param {string} output */
// biome-ignore lint/suspicious/noControlCharactersInRegex: colours are control characters.
const plain = (output) => output.replace(/\u001b\[[0-9;]*m/g, "");

/**
 * The sum of the result lines of `cargo test` and wasm-bindgen-test, which have the same form.
 * @param {string} output
 */
export function rustCounts(output) {
  const results = plain(output).matchAll(/test result: \w+\. (\d+) passed; (\d+) failed; (\d+) ignored/g);
  const counts = Array.from(results, ([, ...n]) => ({
    passed: Number(n[0]),
    failed: Number(n[1]),
    skipped: Number(n[2]),
  }));
  return { ...sum(counts), times: timesIn(output, /^test (\S+) \.\.\. .*<([\d.]+)s>$/gm, 1000) };
}

/**
 * The times that a program prints with the names of its tests.
 * @param {string} output
 * @param {RegExp} pattern finds a name and a time
 * @param {number} unitMs
 * @returns {Timed[]}
 */
const timesIn = (output, pattern, unitMs) =>
  Array.from(plain(output).matchAll(pattern), ([, name = "", time]) => ({ name, ms: unitMs * Number(time) }));

/**
 * The summary of `node --test` in its `spec` form.
 * @param {string} output
 * @returns {Counts}
 */
export function nodeCounts(output) {
  const text = plain(output);
  const number = (/** @type {string} */ name) => Number(new RegExp(`^ℹ ${name} (\\d+)$`, "m").exec(text)?.[1] ?? 0);
  const failed = number("fail") + number("cancelled");
  const times = timesIn(output, /^[✔✖] (.*) \(([\d.]+)ms\)$/gm, 1);
  return { passed: number("pass"), failed, skipped: number("skipped") + number("todo"), times };
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
