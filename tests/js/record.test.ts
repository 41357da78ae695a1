/** The record of a version: the statistics of its guard, by hand and by simulation, and what the guard refuses. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { scriptModule } from "../support/internals.js";
import { Random } from "../support/random.js";

const { signTest, signedRankTest } = await scriptModule("record/paired.mjs");
const { losses } = await scriptModule("record/guard.mjs");
const { summaries } = await scriptModule("record/summary.mjs");

interface Line {
  row: string;
  case: string;
  strict: boolean;
  loose: boolean;
  errors: [number, number, number] | null;
  confidence: number | null;
  ms: number | null;
  work: number;
}

/** Cases of which about nine of ten are right. */
function lines(random: Random, count: number): Line[] {
  return Array.from({ length: count }, (_, i) => {
    const errors = [0.02, 3, 0.02].map((top) => random.between(1e-4, top)) as [number, number, number];
    const strict = random.between(0, 1) < 0.9;
    const confidence = random.between(0, 1);
    return { row: "align", case: `${i}`, strict, loose: true, errors, confidence, ms: 100, work: 3000 };
  });
}

const recordOf = (of: readonly Line[], bytes = 100_000) => ({
  version: "0.0.0",
  sizes: { core: bytes },
  sets: [{ set: "general", lines: of }],
});

test("the sign test is the tail of the binomial distribution", () => {
  // Among three equally likely signs, three losses: 1/8; at least two: 4/8.
  assert.ok(Math.abs(signTest(3, 0) - 1 / 8) < 1e-12);
  assert.ok(Math.abs(signTest(2, 1) - 4 / 8) < 1e-12);
  assert.equal(signTest(0, 0), 1);
  assert.ok(signTest(300, 200) < 1e-5 && signTest(300, 200) > 1e-7);
});

test("the signed-rank test agrees with all orders of signs", () => {
  const seed = 5;
  const random = new Random(seed);
  for (let round = 0; round < 20; round++) {
    const magnitudes = random.list(12, 0.1, 3).map((x) => (random.between(0, 1) < 0.3 ? 1 : x));
    const signs = random.list(12, -1, 1).map(Math.sign);
    // Ranks by counting, ties shared.
    const ranks = magnitudes.map(
      (m) => magnitudes.filter((o) => o < m).length + (magnitudes.filter((o) => o === m).length + 1) / 2,
    );
    const sumOf = (isPositive: (i: number) => boolean) => ranks.reduce((s, r, i) => s + (isPositive(i) ? r : 0), 0);
    const own = sumOf((i) => (signs[i] ?? 0) > 0);
    let atLeast = 0;
    for (let mask = 0; mask < 4096; mask++) atLeast += sumOf((i) => ((mask >> i) & 1) === 1) >= own ? 1 : 0;
    const found = signedRankTest(magnitudes.map((m, i) => m * (signs[i] ?? 0)));
    assert.ok(Math.abs(found - atLeast / 4096) < 0.02, `seed ${seed}, round ${round}: ${found} of ${atLeast / 4096}`);
  }
  assert.equal(signedRankTest([0, 0]), 1);
});

test("the guard passes the same results, and small changes in both directions", () => {
  const seed = 11;
  const random = new Random(seed);
  for (let round = 0; round < 50; round++) {
    const before = lines(random, 240);
    assert.deepEqual(losses(recordOf(before), recordOf(before)), []);
    const after = before.map((line, i) =>
      i % 10 === 0
        ? { ...line, errors: line.errors?.map((e) => e * (i % 20 === 0 ? 1.1 : 1 / 1.1)) as Line["errors"] }
        : line,
    );
    assert.deepEqual(losses(recordOf(before), recordOf(after)), [], `seed ${seed}, round ${round}`);
  }
});

test("the guard refuses a loss of two per cent of the cases, of precision, and more work or bytes", () => {
  const before = lines(new Random(3), 250);
  let left = 5;
  const wrong = before.map((line) => (line.strict && left-- > 0 ? { ...line, strict: false } : line));
  assert.match(
    losses(recordOf(before), recordOf(wrong)).join("\n"),
    /^general, align: 5 of 250 are no longer within strict/,
  );
  const biased = before.map((line) => ({ ...line, errors: line.errors?.map((e) => e * 1.02) as Line["errors"] }));
  assert.match(losses(recordOf(before), recordOf(biased)).join("\n"), /error of scale grows by 2\.0 %/);
  const slow = before.map((line) => ({ ...line, work: 3200 }));
  assert.match(losses(recordOf(before), recordOf(slow)).join("\n"), /3000 -> 3200 renders/);
  assert.match(losses(recordOf(before), recordOf(before, 101_100)).join("\n"), /size of core/);
  assert.match(losses(recordOf(before), recordOf(before.slice(1))).join("\n"), /1 of 250 cases are missing/);
});

test("a summary counts the right poses by confidence", () => {
  const of = (confidence: number | null, strict: boolean): Line => ({
    ...{ row: "align", case: `${confidence}`, strict, loose: true, errors: [0.01, 1, 0.01], ms: 1, work: 1 },
    confidence,
  });
  const [summary] = summaries("general", [of(1, true), of(0.95, false), of(0.05, false), of(null, true)]);
  assert.equal(summary.n, 4);
  assert.equal(summary.strict, 0.5);
  assert.deepEqual(summary.bins.at(-1), [2, 1]);
  assert.deepEqual(summary.bins[0], [1, 0]);
});
