/** The benchmark commands' statistics: medians, success, bins of confidence, kinds of failure. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { scriptModule } from "../support/internals.js";

const script = (name: string) => scriptModule(`bench/${name}`);
const [{ median, mean, share, fixed, markdownTable }, { failure, judged, isWithin, loose, strict }, tables] =
  await Promise.all(["table.mjs", "records.mjs", "search-tables.mjs"].map(script));
const { ablationTable, binOf, failureTable, reliabilityTable } = tables;
const { currentModel, featuresOf, fitLogistic, probability } = await script("confidence-model.mjs");

const right = { scaleError: 0.01, rotationErrorDeg: 2, translationErrorRelative: 0.01 };
const near = { ...right, rotationErrorDeg: 15 };
const wrong = { ...right, rotationErrorDeg: 180 };

function record(tier: string, errors: object | null, confidence: number, score = 1.2) {
  const alignment = errors === null ? null : { confidence, metrics: { iou: 0.9 }, diagnostics: { score } };
  return { name: "case", tier, alignment, errors, truthMetrics: {}, truthScore: 1, seconds: 0.5 };
}

/** The cells of a table's line that begins so. */
function cells(table: string, first: string): string[] {
  const line = table.split("\n").find((candidate) => candidate.startsWith(`| ${first} `));
  assert.ok(line !== undefined, `no line ${first} in\n${table}`);
  return line.split("|").map((cell) => cell.trim());
}

test("a median is the middle value, or the mean of the two in the middle", () => {
  assert.equal(median([3, 1, 2]), 2);
  assert.equal(median([4, 1, 2, 3]), 2.5);
  assert.equal(median([Number.POSITIVE_INFINITY, 1, Number.POSITIVE_INFINITY]), Number.POSITIVE_INFINITY);
  assert.equal(median([Number.POSITIVE_INFINITY, Number.POSITIVE_INFINITY]), Number.POSITIVE_INFINITY);
  for (const nothing of [median([]), mean([]), share([])]) assert.ok(Number.isNaN(nothing));
});

test("tables are Markdown, and nothing is a dash", () => {
  assert.equal(markdownTable(["a", "b"], [["long", 1]]), "| a    |   b |\n|------|----:|\n| long |   1 |");
  assert.deepEqual(
    [fixed(Number.NaN), fixed(null), fixed(Number.POSITIVE_INFINITY), fixed(1.26, 1)],
    ["–", "–", "∞", "1.3"],
  );
});

test("success has a strict tolerance and a loose one, and no answer is none", () => {
  const verdicts = [right, near, wrong, null].map((errors) => [isWithin(errors, strict), isWithin(errors, loose)]);
  assert.deepEqual(verdicts, [
    [true, true],
    [false, true],
    [false, false],
    [false, false],
  ]);
});

test("a wrong pose is the search's fault where the truth scores better", () => {
  assert.equal(failure(record("easy", right, 0.9, 0.5)), null);
  assert.equal(failure(record("easy", wrong, 0.9, 0.9)), "search");
  assert.equal(failure(record("easy", wrong, 0.9, 1)), "scoring");
  assert.equal(failure(record("easy", null, 0)), "unanswered");
});

test("the bins of confidence include their lower ends", () => {
  assert.deepEqual([0, 0.49, 0.5, 0.69, 0.7, 0.9, 1].map(binOf), [0, 0, 1, 1, 2, 3, 3]);
});

test("reliability counts only what was answered and can be judged", () => {
  const unknown = { ...record("easy", right, 0.95), truthMetrics: null };
  const records = [
    record("easy", right, 0.95),
    record("hard", wrong, 0.95),
    record("hard", right, 0.6),
    unknown,
    record("hard", null, 0),
  ];
  assert.equal(judged(records).length, 4);
  const table = reliabilityTable(records);
  assert.deepEqual(cells(table, "0.9 and above").slice(2, 6), ["2", "66.7", "0.950", "50.0"]);
  assert.deepEqual(cells(table, "0.9 and above, easy").slice(2, 6), ["1", "100.0", "0.950", "100.0"]);
  assert.deepEqual(cells(table, "0.9 and above, hard").slice(2, 6), ["1", "50.0", "0.950", "0.0"]);
  assert.deepEqual(cells(table, "0 to 0.5").slice(2, 6), ["0", "0.0", "–", "–"]);
  assert.deepEqual(cells(failureTable(records), "hard").slice(2, 7), ["3", "2", "0", "1", "1"]);
});

test("an ablation shows success by tier, strict and loose", () => {
  const records = [record("easy", right, 1), record("easy", near, 1), record("hard", null, 0)];
  const line = cells(ablationTable([{ row: "everything", records }]), "everything");
  assert.deepEqual(line.slice(2, 8), ["33.3 / 66.7", "50.0 / 100.0", "0.0 / 0.0", "1.00", "15.00", "1.00"]);
  assert.deepEqual(line.slice(8, 12), ["0.900", "0.50", "0", "1"]);
});

test("the features of confidence are those of the core, with its constants", () => {
  const model = currentModel();
  assert.equal(model.slopes.length, 6);
  const terms = { overlap: 0.9, depth: 0.8, outline: 0.7 };
  const alignment = {
    alternatives: [{ score: 1.1 }, { score: 1.05 }],
    uncertainty: { scale: 1e-9, rotationDeg: 5 },
    diagnostics: { score: 1.2, terms },
  };
  const features = featuresOf({ alignment }, model);
  const expected = [0.9, 0.8, 0.7, 0.1 / model.noise, Math.log(model.scale[0]), Math.log(5)];
  for (const [i, value] of expected.entries()) assert.ok(Math.abs(features[i] - value) < 1e-12, `feature ${i}`);
  assert.equal(featuresOf({ alignment: { ...alignment, uncertainty: null } }, model), null);
  assert.equal(featuresOf({ alignment: null }, model), null);
});

test("the fit of confidence finds the line that labels were drawn with", () => {
  const line = { intercept: -1, slopes: [2, -0.5] };
  // Each point stands for a hundred labels, in the line's own proportion.
  const rows: number[][] = [];
  const labels: boolean[] = [];
  for (const x of [-1, -0.5, 0, 0.5, 1]) {
    for (const y of [-3, -1, 1, 3]) {
      const right = Math.round(100 * probability([x, y], line));
      for (let i = 0; i < 100; i++) {
        rows.push([x, y]);
        labels.push(i < right);
      }
    }
  }
  const { intercept, slopes } = fitLogistic(rows, labels);
  for (const [found, expected] of [
    [intercept, -1],
    [slopes[0], 2],
    [slopes[1], -0.5],
  ])
    assert.ok(Math.abs(found - expected) < 0.02, `${found}, expected ${expected}`);
  // Labels that a threshold separates still have a finite line.
  const separated = fitLogistic([[0], [1], [2], [3]], [false, false, true, true]);
  assert.ok(separated.slopes[0] > 1 && Number.isFinite(separated.slopes[0]));
});
