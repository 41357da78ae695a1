/**
 * `npm run bench:fit`: fits the regression behind `confidence` to generated cases, prints its constants as
 * `src/precise/judged/confidence.rs` declares them, and how reliable they are on other cases, real ones among them where their
 * folders are given: nothing is fitted to these.
 */
import { command, count } from "./command.mjs";
import { currentModel, featuresOf, fitLogistic, probability } from "./confidence-model.mjs";
import { benchmarkRows, isWithin, judged, strict } from "./records.mjs";
import { reliabilityTable } from "./search-tables.mjs";
import { fixed, markdownTable, mean } from "./table.mjs";

/** @typedef {import("./records.mjs").BenchRecord} BenchRecord */
/** @typedef {import("./confidence-model.mjs").Line} Line */
/** @typedef {{ record: BenchRecord, features: number[], isRight: boolean }} Sample */
/** @typedef {{ cases: number, setSeed: number, testCases: number, testSeed: number, real?: string[], threads?: number, keep: string, reuse?: boolean }} FitOptions */

/** Both searches of the default quality: the confidence of the first decides whether there is a second. */
const rows = ["fast: quality=fast", "best: quality=best"];

/**
 * The poses that the regression applies to: of general cases, of those with the mesh of another object, where no pose is
 * right, and of cases with the effects of depth sensors. Of six cases, three, one and two are of these kinds.
 * @param {string} name
 * @param {number} cases
 * @param {number} setSeed
 * @param {FitOptions} options
 * @returns {Promise<Sample[]>}
 */
async function samples(name, cases, setSeed, options) {
  const part = (/** @type {number} */ share) => Math.ceil((cases * share) / 6);
  return [
    ...(await samplesOf(`${name}-general`, { set: "general", setSeed, cases: part(3), misfits: part(1) }, options)),
    ...(await samplesOf(`${name}-sensors`, { set: "sensors", setSeed, cases: part(2) }, options)),
  ];
}

/**
 * @param {string} name
 * @param {Omit<import("./records.mjs").BenchOptions, "json">} cases
 * @param {FitOptions} options
 * @returns {Promise<Sample[]>}
 */
async function samplesOf(name, cases, { threads, keep, reuse }) {
  const json = `${keep}/${name}.json`;
  const shared = { json, ...(threads === undefined ? {} : { threads }), ...(reuse ? { from: json } : {}) };
  const records = (await benchmarkRows({ ...cases, ...shared }, rows)).flatMap((row) => row.records);
  const model = currentModel();
  return judged(records).flatMap((record) => {
    const features = featuresOf(record, model);
    if (features === null) return [];
    // The features here and those of the core are the same: they give the same confidence.
    const [expected, found] = [record.alignment?.confidence ?? Number.NaN, probability(features, model)];
    if (!(Math.abs(found - expected) < 1e-9)) {
      throw new Error(
        `${record.name}: confidence ${expected}, but ${found} by the constants of src/precise/judged/confidence.rs. Remedy: ` +
          "run the cases again with this version of the code, or make featuresOf() agree with it.",
      );
    }
    return [{ record, features, isRight: record.class !== "misfit" && isWithin(record.errors, strict) }];
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
async function fit(options) {
  const training = await samples("training", options.cases, options.setSeed, options);
  const test = await samples("test", options.testCases, options.testSeed, options);
  const { real: folders } = options;
  const real = folders ? await samplesOf("real", { folders }, options) : [];
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
  const table = Object.entries(lines).map(([name, each]) => [name, ...losses(training, each), ...losses(test, each)]);
  const head = ["constants", "training: Brier", "log loss", "test: Brier", "log loss"];
  console.log(`${markdownTable(head, table)}\n\n${training.length} poses for training, ${test.length} for the test.`);
  for (const [name, each] of Object.entries(lines)) {
    console.log(`\nTest cases, constants ${name}\n\n${reliabilityTable(predicted(test, each))}`);
  }
  if (real.length > 0) {
    console.log(`\nReal cases, constants fitted\n\n${reliabilityTable(predicted(real, rounded))}`);
  }
}

await command("bench:fit", (program) =>
  program
    .description("Fits the regression behind `confidence` to generated cases, and tests it on others.")
    .option("--cases <n>", "generated cases to fit to", count, 600)
    .option("--set-seed <s>", "their seed", Number, 5)
    .option("--test-cases <n>", "generated cases of the test", count, 240)
    .option("--test-seed <s>", "their seed", Number, 1)
    .option("--real <folders...>", "case folders with a truth, or folders of them, to test on as well")
    .option("--threads <n>", "all by default", count)
    .option("--keep <folder>", "keep everything about all cases here", "target/bench/fit")
    .option("--reuse", "take the cases that an earlier run has kept")
    .action(fit),
);
