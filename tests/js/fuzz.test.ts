/** A fixed number of executions of the fuzzer; `npm run fuzz` runs it for as long as you like. */
import { after, test } from "node:test";
import { targets } from "../support/fuzz/fuzzer.js";

const { calls, storms, end } = await targets();
after(end);

for (const [name, target, count] of [
  ["calls with odd arguments", calls, 1500],
  ["storms of a pool", storms, 40],
] as const) {
  test(`${count} ${name} settle, with results or typed errors`, async () => {
    for (let seed = 1; seed <= count; seed++) await target(seed);
  });
}
