/** A few seeds of the fuzzer; `npm run fuzz` runs it for as long as you like. */
import { test } from "node:test";
import { fuzzer } from "../support/fuzz.js";

test("random calls settle with a result or a typed error, alike with workers and without", {
  timeout: 300_000,
}, async () => {
  const { run, end } = await fuzzer();
  for (let seed = 1; seed <= 60; seed++) await run(seed);
  await end();
});
