/**
 * `npm run bench:fit`: fits the regression behind `confidence` to generated cases, prints its constants as
 * `src/precise/confidence.rs` declares them, and how reliable they are on other cases.
 */
import { command, count } from "./command.mjs";
import { currentModel, featuresOf, fitLogistic, probability } from "./confidence-model.mjs";
import { benchmarkRows, isWithin, judged, strict } from "./records.mjs";
import { reliabilityTable } from "./search-tables.mjs";
import { fixed, markdownTable, mean } from "./table.mjs";

/** @typedef {import("./records.mjs").BenchRecord} BenchRecord */
/** @typedef {import("./confidence-model.mjs").Line} Line */
/** @typedef {{ record: BenchRecord, features: number[], isRight: boolean }} Sample */

/** @typedef {object} FitOptions
 * @property {number} cases
 * @property {number} setSeed
 * @property {number} testCases
 * @property {number} testSeed
 * @property {number} [threads]
 * @property {string} json
 * @property {string} testJson
 * @property {string} [from]
 * @property {string} [testFrom]
 */

/**
 * The poses that the regression applies to.
 * @param {import("./records.mjs").BenchOptions} options
 * @returns {Promise<Sample[]>}
 */
async function samples(options) {
  const model = currentModel();
  const [row] = await benchmarkRows(options, ["everything:"]);
  return judged(row?.records ?? []).flatMap((record) => {
    const features = featuresOf(record, model);
    if (features === null) return [];
    // The features here and those of the core are the same: they give the same confidence.
    const [expected, found] = [record.alignment?.confidence ?? Number.NaN, probability(features, model)];
    if (!(Math.abs(found - expected) < 1e-9)) {
      throw new Error(
        `${record.name}: confidence ${expected}, but ${found} by the constants of src/precise/confidence.rs. Remedy: ` +
          "run the cases again with this version of the code, or make featuresOf() agree with it.",
      );
    }
    return [{ record, features, isRight: isWithin(record.errors, strict) }];
  });
}

/** The Brier score and the logarithmic loss of a line: lower is better. @param {readonly Sample[]} all @param {Line} line */
function losses(all, line) {
  const confidences = all.map(({ features }) => Math.min(Math.max(probability(features, line), 1e-12), 1 - 1e-12));
  const brier = mean(confidences.map((p, i) => (p - Number(all[i]?.isRight)) ** 2));
  const logarithmic = mean(confidences.map((p, i) => -Math.log(all[i]?.isRight ? p : 1 - p)));
  return [fixed(brier, 4), fixed(logarithmic, 4)];
}

/** The records as if this line were in the code. @param {readonly Sample[]} all @param {Line} line */
const predicted = (all, line) =>
  all.flatMap(({ record, features }) =>
    record.alignment ? { ...record, alignment: { ...record.alignment, confidence: probability(features, line) } } : [],
  );

/** @param {FitOptions} options */
async function fit({ cases, setSeed, testCases, testSeed, threads, json, testJson, from, testFrom }) {
  const shared = threads === undefined ? {} : { threads };
  const given = (/** @type {string | undefined} */ file) => (file === undefined ? {} : { from: file });
  const training = await samples({ ...shared, cases, setSeed, json, ...given(from) });
  const test = await samples({ ...shared, cases: testCases, setSeed: testSeed, json: testJson, ...given(testFrom) });
  const line = fitLogistic(
    training.map(({ features }) => features),
    training.map(({ isRight }) => isRight),
  );
  // As many digits as the code has: what is measured is what can be copied.
  const rounded = {
    intercept: Number(line.intercept.toFixed(3)),
    slopes: line.slopes.map((x) => Number(x.toFixed(3))),
  };
  console.log(`
const INTERCEPT: f64 = ${rounded.intercept.toFixed(3)};
const SLOPES: [f64; ${rounded.slopes.length}] = [${rounded.slopes.map((x) => x.toFixed(3)).join(", ")}];
`);
  const lines = { fitted: rounded, "in the code": currentModel() };
  const rows = Object.entries(lines).map(([name, each]) => [name, ...losses(training, each), ...losses(test, each)]);
  const head = ["constants", "training: Brier", "log loss", "test: Brier", "log loss"];
  console.log(`${markdownTable(head, rows)}\n\n${training.length} poses for training, ${test.length} for the test.`);
  for (const [name, each] of Object.entries(lines)) {
    console.log(`\nTest cases, constants ${name}\n\n${reliabilityTable(predicted(test, each))}`);
  }
}

await command("bench:fit", (program) =>
  program
    .description("Fits the regression behind `confidence` to generated cases, and tests it on others.")
    .option("--cases <n>", "generated cases to fit to", count, 720)
    .option("--set-seed <s>", "their seed", Number, 0)
    .option("--test-cases <n>", "generated cases of the test", count, 240)
    .option("--test-seed <s>", "their seed", Number, 1)
    .option("--threads <n>", "all by default", count)
    .option("--json <file>", "keep everything about the training cases here", "target/bench/fit.json")
    .option("--test-json <file>", "keep everything about the test cases here", "target/bench/fit-test.json")
    .option("--from <file>", "take the training cases that an earlier run has kept")
    .option("--test-from <file>", "take the test cases that an earlier run has kept")
    .action(fit),
);
