/** A fixed number of executions of the fuzzer; `npm run fuzz` runs it for as long as you like. */
import assert from "node:assert/strict";
import { after, test } from "node:test";
import * as conventionsModule from "sim3align/conventions";
import { calledNames } from "../support/fuzz/conventions.js";
import { targets } from "../support/fuzz/fuzzer.js";

const { calls, storms, sideBySide, conventions, end } = await targets();
after(end);

for (const [name, target, count] of [
  ["calls with odd arguments", calls, 1500],
  ["storms of a pool", storms, 40],
  ["calls side by side without workers", sideBySide, 30],
  ["calls of the conventions with odd arguments", conventions, 5000],
] as const) {
  test(`${count} ${name} settle, with results or typed errors`, async () => {
    for (let seed = 1; seed <= count; seed++) await target(seed);
  });
}

test("all functions of the conventions are called", () => {
  const functions = Object.entries(conventionsModule).filter(
    ([name, value]) => typeof value === "function" && name !== "Sim3AlignError",
  );
  assert.deepEqual(new Set(calledNames), new Set(functions.map(([name]) => name)));
});
