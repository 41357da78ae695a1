/**
 * `npm test`: every test. `npm test -- --only native,js` runs some suites.
 *
 * Two suites run at a time; their output comes when they end. A failing suite does not stop the others, except that
 * without the package there is nothing to try. The last line is the sum over all suites.
 */
import { parseArgs } from "node:util";
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

/**
 * @typedef {object} Suite
 * @property {string} title
 * @property {() => Promise<import("./lib/counts.mjs").Counts>} run
 * @property {string} [after] the suite that has to have passed: `build` where the built package is used
 */

/** In the order in which they begin: those that use the package begin while cargo has other work. @type {Record<string, Suite>} */
const suites = {
  build: { title: "Build of the package", run: () => runChecks([["package", buildPackage]]) },
  native: { title: "Rust tests, native", run: native },
  js: { title: "JavaScript tests on the installed package", run: javaScript, after: "build" },
  wasm: { title: "Rust tests, WebAssembly in Node", run: wasm },
  browser: { title: "Browser tests", run: browser, after: "build" },
  lint: { title: "Formatters, linters and types", run: lint, after: "build" },
  commands: { title: "Commands in their smallest form", run: commands, after: "build" },
  bundlers: { title: "The package in bundlers' apps", run: bundlers, after: "build" },
  examples: { title: "Examples", run: examples, after: "build" },
  runtimes: { title: "The package in other runtimes", run: runtimes, after: "build" },
  package: { title: "Package checks", run: checkPackage, after: "build" },
};

const LANES = 2;

/** The suites that the command line selects, and the build that they need. */
function selected() {
  const { values } = parseArgs({ options: { only: { type: "string" } } });
  const names = values.only?.split(",") ?? Object.keys(suites);
  const unknown = names.filter((name) => !(name in suites));
  if (unknown.length > 0) {
    throw new Error(`--only: no suite ${unknown.join(", ")}. There are ${Object.keys(suites).join(", ")}.`);
  }
  const needed = new Set([...names, ...names.flatMap((name) => suites[name]?.after ?? [])]);
  return Object.entries(suites).filter(([name]) => needed.has(name));
}

/** @param {Suite} suite */
async function outcome({ title, run }) {
  print(`\n━━ ${title} ${"━".repeat(Math.max(0, 76 - title.length))}\n`);
  try {
    const counts = await run();
    if (counts.passed + counts.failed + counts.skipped > 0) return counts;
    print("No test ran, which counts as a failure.\n");
  } catch (error) {
    explain(error);
  }
  return { ...noTests(), failed: 1 };
}

/** @typedef {{ name: string, counts: import("./lib/counts.mjs").Counts, ms: number }} Result */

/**
 * Runs suites, {@link LANES} at a time, each after the one that it needs.
 * @param {readonly (readonly [name: string, suite: Suite])[]} chosen
 */
async function runAll(chosen) {
  /** @type {Map<string, Result>} */
  const done = new Map();
  const waiting = [...chosen];
  /** @type {Set<Promise<void>>} */
  const running = new Set();
  const start = async (/** @type {string} */ name, /** @type {Suite} */ suite) => {
    const started = performance.now();
    const end = (/** @type {Result["counts"]} */ counts) => {
      done.set(name, { name, counts, ms: performance.now() - started });
    };
    if (done.get(suite.after ?? "")?.counts.failed) {
      print(`\n${suite.title}: not run, for the build failed.\n`);
      end({ ...noTests(), skipped: 1 });
    } else if (chosen.length === 1) end(await outcome(suite));
    else {
      print(`${name} … (${chosen.length - waiting.length} of ${chosen.length})\n`);
      const { result: counts, output } = await collect(() => outcome(suite));
      print(output);
      end(counts);
    }
  };
  while (waiting.length + running.size > 0) {
    const ready = waiting.findIndex(([, { after }]) => after === undefined || done.has(after));
    if (ready >= 0 && running.size < LANES) {
      for (const [name, suite] of waiting.splice(ready, 1)) {
        const ended = start(name, suite).finally(() => running.delete(ended));
        running.add(ended);
      }
    } else await Promise.race(running);
  }
  return chosen.flatMap(([name]) => done.get(name) ?? []);
}

/** The longest tests of each suite that takes a while. */
const SLOWEST = 3;
const SLOW_MS = 1000;

/** @param {readonly Result[]} results */
function printSlowest(results) {
  const lines = results.flatMap(({ name: suite, counts: { times = [] } }) => {
    const slow = times.filter(({ ms }) => ms >= SLOW_MS).sort((a, b) => b.ms - a.ms);
    return slow.slice(0, SLOWEST).map(({ name, ms }) => `${suite.padEnd(10)}${duration(ms).padStart(12)}  ${name}\n`);
  });
  if (lines.length > 0) print(`\nslowest\n${lines.join("")}`);
}

await script(async () => {
  const started = performance.now();
  const results = await runAll(selected());
  printSlowest(results);
  const line = (/** @type {readonly unknown[]} */ cells) =>
    print(`${cells.map((cell, i) => (i > 0 ? `${cell}`.padStart(i < 4 ? 8 : 14) : `${cell}`.padEnd(10))).join("")}\n`);
  print("\n");
  line(["suite", "passed", "failed", "skipped", "time"]);
  for (const { name, counts, ms } of results) {
    line([name, counts.passed, counts.failed, counts.skipped, duration(ms)]);
  }
  const total = sum(results.map(({ counts }) => counts));
  print(`\nAll took ${duration(performance.now() - started)}.\n`);
  print(`${total.passed} passed, ${total.failed} failed, ${total.skipped} skipped\n`);
  if (total.failed > 0) process.exitCode = 1;
});
