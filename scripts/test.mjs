/**
 * `npm test`: every test. `npm test -- --only native,js` runs some suites, `npm test -- --all` also what takes long and repeats
 * what others test: other runtimes, simulators, notebooks, servers, and the commands that measure.
 *
 * Two lanes of suites run side by side, and whichever is free takes what belongs to neither; the output of a suite comes when it
 * ends. A failing suite does not stop the others, except that without the package there is nothing to try. The last line is the
 * sum over all suites.
 */
import { parseArgs } from "node:util";
import { once } from "./lib/cache.mjs";
import { noTests, sum } from "./lib/counts.mjs";
import { collect, print } from "./lib/output.mjs";
import { buildPackage } from "./lib/package.mjs";
import { duration, explain, runChecks, script } from "./lib/step.mjs";
import { commands } from "./suites/commands.mjs";
import { bundlers, runtimes } from "./suites/hosts.mjs";
import { browser, examples, javaScript } from "./suites/installed.mjs";
import { lint } from "./suites/lint.mjs";
import { checkPackage } from "./suites/package.mjs";
import { native, wasm } from "./suites/rust.mjs";

/** @typedef {import("./lib/counts.mjs").Counts} Counts */
/**
 * @typedef {object} Suite
 * @property {string} title
 * @property {(isAll: boolean) => Promise<Counts>} run
 * @property {0 | 1} [lane]
 * @property {boolean} [needsNoPackage]
 * @property {boolean} [isHeavy] whether it is left out without `--all`
 */

/** In the order of each lane: cargo compiles the tests beside the package, and browsers, which wait a lot, run beside them. @type {Record<string, Suite>} */
const suites = {
  native: { title: "Rust tests, native", run: native, lane: 0, needsNoPackage: true },
  wasm: { title: "Rust tests, WebAssembly in Node", run: wasm, lane: 0, needsNoPackage: true },
  lint: { title: "Formatters, linters and types", run: lint, lane: 0 },
  commands: { title: "Commands in their smallest form", run: commands, lane: 0 },
  js: { title: "JavaScript tests on the installed package", run: javaScript, lane: 1 },
  browser: { title: "Browser tests", run: browser, lane: 1 },
  bundlers: { title: "The package in bundlers' apps", run: bundlers },
  examples: { title: "Examples", run: examples },
  runtimes: { title: "The package in other runtimes", run: runtimes, isHeavy: true },
  package: { title: "Package checks", run: checkPackage },
};

const { values } = parseArgs({ options: { only: { type: "string" }, all: { type: "boolean", default: false } } });
const only = values.only?.split(",");
/** @type {{ name: string, counts: Counts, ms: number }[]} */
const results = [];

/** @param {Pick<Suite, "title" | "run">} suite @returns {Promise<Counts>} */
async function outcome({ title, run }) {
  print(`\n━━ ${title} ${"━".repeat(Math.max(0, 76 - title.length))}\n`);
  try {
    const counts = await run(values.all);
    if (counts.passed + counts.failed + counts.skipped > 0) return counts;
    print("No test ran, which counts as a failure.\n");
  } catch (error) {
    explain(error);
  }
  return { ...noTests(), failed: 1 };
}

/** Runs a suite and shows its output: as it comes, where no other suite runs. @param {string} name @param {Pick<Suite, "title" | "run">} suite */
async function runSuite(name, suite) {
  const started = performance.now();
  if (only?.length === 1) return end(await outcome(suite));

  print(`${name} …\n`);
  const { result, output } = await collect(() => outcome(suite));
  print(output);
  return end(result);

  function end(/** @type {Counts} */ counts) {
    results.push({ name, counts, ms: performance.now() - started });
    return counts;
  }
}

const build = once(() =>
  runSuite("build", { title: "Build of the package", run: () => runChecks([["package", buildPackage]]) }),
);

/** The suites that nobody has begun. */
const waiting = Object.entries(suites).filter(
  ([name, { isHeavy }]) => only?.includes(name) ?? (values.all || !isHeavy),
);

/** @param {0 | 1} lane */
async function runLane(lane) {
  for (;;) {
    const next = [lane, undefined].map((of) => waiting.findIndex(([, suite]) => suite.lane === of)).find((i) => i >= 0);
    if (next === undefined) return;
    const [[name, suite]] = /** @type {[[string, Suite]]} */ (waiting.splice(next, 1));
    if (!suite.needsNoPackage && (await build()).failed > 0) print(`\n${name}: not run, for the build failed.\n`);
    else await runSuite(name, suite);
  }
}

await script(async () => {
  const started = performance.now();
  const unknown = only?.filter((name) => !(name in suites)) ?? [];
  if (unknown.length > 0)
    throw new Error(`--only: no suite ${unknown.join(", ")}. There are ${Object.keys(suites).join(", ")}.`);
  await Promise.all([runLane(0), runLane(1)]);

  const line = (/** @type {readonly unknown[]} */ cells) =>
    print(`${cells.map((cell, i) => (i > 0 ? `${cell}`.padStart(i < 4 ? 8 : 14) : `${cell}`.padEnd(10))).join("")}\n`);
  print("\n");
  line(["suite", "passed", "failed", "skipped", "time"]);
  for (const { name, counts, ms } of results) line([name, counts.passed, counts.failed, counts.skipped, duration(ms)]);

  const total = sum(results.map(({ counts }) => counts));
  print(`\nAll took ${duration(performance.now() - started)}.\n`);
  print(`${total.passed} passed, ${total.failed} failed, ${total.skipped} skipped\n`);
  if (total.failed > 0) process.exitCode = 1;
});
