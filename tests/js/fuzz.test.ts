/** Calls of one seed of the fuzzer; `npm run fuzz` runs it with one seed after the other. */
import { test } from "node:test";
import { fuzzer } from "../support/fuzz.js";

const first = 60 * Number(process.env.SIM3ALIGN_FUZZ_SEED ?? 1);

test("random calls settle with a result or a typed error, alike with workers and without", async () => {
  const { run, end } = await fuzzer();
  for (let seed = first; seed < first + 60; seed++) await run(seed);
  await end();
});
