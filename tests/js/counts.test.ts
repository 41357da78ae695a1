/** The test script's own reading of what other programs print: a wrong one would hide failures. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { scriptModule } from "../support/internals.js";

const { hungFiles, nodeCounts, rustCounts, withStatus } = await scriptModule("lib/counts.mjs");

test("the result lines of all Rust test programs are added, in colour or not, with the times of the tests", () => {
  const output = [
    "test kd_tree::nearest ... ok <1.250s>",
    "test result: ok. 12 passed; 0 failed; 3 ignored; 0 measured; 0 filtered out; finished in 0.10s",
    "test a::b ... FAILED",
    "test result: \u001b[31mFAILED\u001b[0m. 4 passed; 2 failed; 0 ignored; 0 filtered out; finished in 1s",
  ].join("\n");
  assert.deepEqual(rustCounts(output), {
    passed: 16,
    failed: 2,
    skipped: 3,
    times: [{ name: "kd_tree::nearest", ms: 1250 }],
  });
});

test("output without a result line counts nothing", () => {
  assert.deepEqual(rustCounts("error: could not compile"), { passed: 0, failed: 0, skipped: 0, times: [] });
});

test("Node's summary is read, cancelled tests as failed", () => {
  const summary = ["tests 9", "suites 0", "pass 4", "fail 1", "cancelled 2", "skipped 1", "todo 1", "duration_ms 5"];
  const output = ["✔ pass 100 balls (1.5ms)", ...summary.map((line) => `\u001b[34mℹ ${line}\u001b[39m`)].join("\n");
  assert.deepEqual(nodeCounts(output), {
    passed: 4,
    failed: 3,
    skipped: 2,
    times: [{ name: "pass 100 balls", ms: 1.5 }],
  });
});

test("files of tests that hang are told from tests that fail, each once", () => {
  const hung =
    "\u001b[31m✖ /tests/js/pool.test.js \u001b[90m(900000.5ms)\u001b[39m\u001b[39m\n  'test timed out after 900000ms'\n";
  const failed = "✖ a mesh is read (3.5ms)\n  'expected 3'\n";
  assert.deepEqual(hungFiles(`${hung}${failed}\n✖ failing tests:\n\n${hung}`), ["/tests/js/pool.test.js"]);
});

test("a program that ends badly has failed, whatever it counted", () => {
  const counts = { passed: 3, failed: 0, skipped: 0 };
  assert.equal(withStatus(counts, false).failed, 1);
  assert.equal(withStatus(counts, true).failed, 0);
  assert.equal(withStatus({ ...counts, failed: 2 }, false).failed, 2);
});
