/**
 * `npm test`: every test. `npm test -- --only native,js` runs some suites.
 *
 * A failing suite does not stop the others, except that without a build there is nothing to try. The last line is the
 * sum over all suites.
 */
import { parseArgs } from "node:util";
import { noTests, sum } from "./lib/counts.mjs";
import { buildPackage } from "./lib/package.mjs";
import { setUp } from "./lib/setup.mjs";
import { duration, explain, script } from "./lib/step.mjs";
import { examples } from "./suites/examples.mjs";
import { lint, types } from "./suites/lint.mjs";
import { browser, bundlers, javaScript, lintPackage } from "./suites/package.mjs";
import { runtimes } from "./suites/runtimes.mjs";
import { native, wasm } from "./suites/rust.mjs";
import { checkSizes } from "./suites/size.mjs";

/**
 * @typedef {object} Suite
 * @property {string} name
 * @property {string} title
 * @property {() => Promise<import("./lib/counts.mjs").Counts>} run
 * @property {boolean} [usesPackage] whether it needs the built package
 */

/** @type {readonly Suite[]} */
const suites = [
  { name: "lint", title: "Formatters and linters", run: lint },
  { name: "native", title: "Rust tests, native", run: native },
  { name: "wasm", title: "Rust tests, WebAssembly in Node", run: wasm },
  { name: "build", title: "Build of the package", run: build },
  { name: "types", title: "Type checks", run: types, usesPackage: true },
  { name: "size", title: "Size budgets", run: checkSizes, usesPackage: true },
  { name: "package", title: "Package checks", run: lintPackage, usesPackage: true },
  { name: "js", title: "JavaScript tests on the installed package", run: javaScript, usesPackage: true },
  { name: "browser", title: "Browser tests", run: browser, usesPackage: true },
  { name: "bundlers", title: "The package in bundlers' apps", run: bundlers, usesPackage: true },
  { name: "runtimes", title: "The package in other runtimes", run: runtimes, usesPackage: true },
  { name: "examples", title: "Examples", run: examples, usesPackage: true },
];

async function build() {
  await buildPackage();
  return { passed: 1, failed: 0, skipped: 0 };
}

/** @returns {Suite[]} those that the command line selects, and the build that they need */
function selected() {
  const { values } = parseArgs({ options: { only: { type: "string" } } });
  if (values.only === undefined) return [...suites];
  const names = values.only.split(",");
  const unknown = names.filter((name) => !suites.some((suite) => suite.name === name));
  if (unknown.length > 0) {
    throw new Error(`--only: no suite ${unknown.join(", ")}. There are ${suites.map(({ name }) => name).join(", ")}.`);
  }
  const chosen = suites.filter(({ name }) => names.includes(name));
  const needsBuild = chosen.some(({ usesPackage }) => usesPackage);
  return suites.filter((suite) => chosen.includes(suite) || (needsBuild && suite.name === "build"));
}

/**
 * @param {Suite} suite
 * @param {boolean} isBuilt
 */
async function outcome(suite, isBuilt) {
  console.log(`\n━━ ${suite.title} (${suite.name}) ${"━".repeat(Math.max(0, 70 - suite.title.length))}`);
  if (suite.usesPackage && !isBuilt) {
    console.log("Not run: the build failed.");
    return { ...noTests(), skipped: 1 };
  }
  try {
    const counts = await suite.run();
    if (counts.passed + counts.failed + counts.skipped > 0) return counts;
    console.error("No test ran, which counts as a failure.");
  } catch (error) {
    explain(error);
  }
  return { ...noTests(), failed: 1 };
}

await script(async () => {
  const chosen = selected();
  await setUp();
  let total = noTests();
  let isBuilt = true;
  const rows = [];
  for (const suite of chosen) {
    const started = performance.now();
    const counts = await outcome(suite, isBuilt);
    if (suite.name === "build") isBuilt = counts.failed === 0;
    total = sum(total, counts);
    const { passed, failed, skipped } = counts;
    rows.push({ suite: suite.name, passed, failed, skipped, time: duration(performance.now() - started) });
  }
  console.log();
  const widths = [10, 8, 8, 8, 14];
  const line = (/** @type {readonly unknown[]} */ cells) =>
    console.log(cells.map((cell, i) => (i ? `${cell}`.padStart(widths[i] ?? 0) : `${cell}`.padEnd(10))).join(""));
  line(["suite", "passed", "failed", "skipped", "time"]);
  for (const row of rows) line(Object.values(row));
  console.log(`\n${total.passed} passed, ${total.failed} failed, ${total.skipped} skipped`);
  if (total.failed > 0) process.exitCode = 1;
});
