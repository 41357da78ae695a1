/**
 * `npm run fit`: fits the regression behind `confidence` to generated cases, prints its constants as
 * `src/precise/verdict/confidence.rs` declares them, and how reliable they are on other cases. Where folders of real cases are
 * given, the intercept is fitted to these, too: each folder is a sensor, and weighs as much as a generated set. The reliability on
 * each folder is printed for the intercept fitted to all others.
 */
import { mkdirSync, readFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { command, count } from "./bench/command.mjs";
import { readResults } from "./bench/results.mjs";
import { fixed, markdownTable, mean } from "./bench/table.mjs";
import { runLab, threadArguments } from "./lib/lab.mjs";
import { at } from "./lib/paths.mjs";
import { reliability, reliabilityHeads } from "./record/summary.mjs";

/** @typedef {import("./bench/results.mjs").ResultRow} ResultRow */
/** @typedef {{ intercept: number, slopes: readonly number[] }} Line in the space of the features */
/** @typedef {[low: number, high: number]} Limits */
/** @typedef {Line & { noise: number, scale: Limits, rotationDeg: Limits, misfit: number, minMisfit: number }} Model */
/** @typedef {{ result: ResultRow, features: number[], isRight: boolean }} Sample */
/** @typedef {{ cases: number, seed: number, testCases: number, testSeed: number, real?: string[], threads?: number, keep: string }} FitOptions */

/** The index of the margin among the features. */
const MARGIN = 3;
/** Weight of the penalty on slopes, which keeps them finite where the features separate right from wrong. */
const PENALTY = 1e-3;
const MAX_STEPS = 100;
/** Both searches of the default quality: the confidence of the first decides whether there is a second. */
const ROWS = ["fast: quality=fast color=false", "best: quality=best color=false"];
/** General cases, those with the mesh of another object, where no pose is right, and those with effects of sensors: shares. */
const SETS = {
  general: { set: "general", part: 1 / 2, suffix: "" },
  misfits: { set: "general", part: 1 / 6, suffix: " misfit=true" },
  sensors: { set: "sensors", part: 1 / 3, suffix: "" },
};

/** A constant of the sources, which is declared there alone. @param {string} file in src/precise @param {string} name */
function declared(file, name) {
  const source = readFileSync(at("src", "precise", file), "utf8");
  const value = new RegExp(`const ${name}: [^=]+= \\[?([^\\];]+)`).exec(source)?.[1];
  if (value === undefined) throw new Error(`src/precise declares no ${name}. Remedy: correct scripts/fit.mjs.`);
  return value.split(",").map(Number);
}

const CONFIDENCE = "verdict/confidence.rs";
const CONDITIONING = "scoring/conditioning.rs";
/** A 32-bit number there. */
const NOISE = Math.fround(declared("scoring/score.rs", "NOISE")[0] ?? Number.NaN);
/** The logarithm of the odds between two poses at a margin of 1. */
const RIVAL_LOG_ODDS = NOISE / (declared(CONDITIONING, "DROP")[0] ?? Number.NaN);

/** The constants in the code. @returns {Model} */
function currentModel() {
  const limits = (/** @type {string} */ name) => /** @type {Limits} */ (declared(CONFIDENCE, name));
  return {
    intercept: declared(CONFIDENCE, "INTERCEPT")[0] ?? Number.NaN,
    slopes: declared(CONFIDENCE, "SLOPES"),
    noise: NOISE,
    scale: limits("SCALE"),
    rotationDeg: limits("ROTATION_DEG"),
    misfit: declared(CONDITIONING, "MISFIT")[0] ?? Number.NaN,
    minMisfit: declared(CONDITIONING, "MIN_MISFIT")[0] ?? Number.NaN,
  };
}

/**
 * The features of a pose; null where there is none that the regression applies to.
 * @param {ResultRow} result
 * @param {Model} model
 */
function featuresOf({ features }, { noise, scale, rotationDeg, misfit, minMisfit }) {
  if (!features?.uncertainty) return null;
  const { score, terms, alternatives, uncertainty } = features;
  const margin = Math.min(noise, ...alternatives.map((other) => score - other));
  const log = (/** @type {number} */ x, /** @type {Limits} */ [low, high]) =>
    Math.log(Math.min(Math.max(x, low), high));
  // The confidence takes the deviation of the curvature alone.
  const curvature = uncertainty[0] / (misfit * (2 - (terms[1] ?? 0) - (terms[2] ?? 0) + minMisfit));
  return [...terms, Math.max(margin, 0) / noise, log(curvature, scale), log(uncertainty[1], rotationDeg)];
}

/** @param {readonly number[]} a @param {readonly number[]} b */
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * (b[i] ?? 0), 0);

const logistic = (/** @type {number} */ logOdds) => 1 / (1 + Math.exp(-logOdds));

/** @param {readonly number[]} features @param {Line} line */
const probability = (features, { intercept, slopes }) =>
  logistic(dot(features, slopes) + intercept) * logistic(RIVAL_LOG_ODDS * (features[MARGIN] ?? 0));

/**
 * Logistic regression by Newton's method, on features of mean 0 and variance 1. The same rows give the same line.
 * @param {readonly Sample[]} samples
 * @returns {Line}
 */
function fitLogistic(samples) {
  const rows = samples.map(({ features }) => features);
  const columns = (rows[0] ?? []).map((_, j) => rows.map((row) => row[j] ?? Number.NaN));
  const means = columns.map((column) => mean(column));
  const deviations = columns.map((column, j) => Math.sqrt(mean(column.map((x) => (x - (means[j] ?? 0)) ** 2))) || 1);
  const standard = rows.map((row) => [1, ...row.map((x, j) => (x - (means[j] ?? 0)) / (deviations[j] ?? 1))]);
  let weights = new Array(columns.length + 1).fill(0);
  for (let step = 0; step < MAX_STEPS; step++) {
    const change = newtonStep(
      standard,
      samples.map(({ isRight }) => isRight),
      weights,
    );
    weights = weights.map((weight, j) => weight + (change[j] ?? 0));
    if (Math.max(...change.map(Math.abs)) < 1e-12) break;
  }
  const slopes = weights.slice(1).map((weight, j) => weight / (deviations[j] ?? 1));
  return { intercept: weights[0] - dot(means, slopes), slopes };
}

/**
 * @param {readonly (readonly number[])[]} rows
 * @param {readonly boolean[]} labels
 * @param {readonly number[]} weights
 */
function newtonStep(rows, labels, weights) {
  const size = weights.length;
  const penalty = (/** @type {number} */ j) => (j === 0 ? 0 : PENALTY);
  const system = weights.map((weight, j) =>
    Array.from({ length: size + 1 }, (_, k) => (k === size ? -penalty(j) * weight : j === k ? penalty(j) : 0)),
  );
  for (const [i, row] of rows.entries()) {
    const p = logistic(dot(row, weights));
    for (const [j, equation] of system.entries()) {
      const x = row[j] ?? 0;
      for (let k = 0; k < size; k++) equation[k] = (equation[k] ?? 0) + p * (1 - p) * x * (row[k] ?? 0);
      equation[size] = (equation[size] ?? 0) + (Number(labels[i]) - p) * x;
    }
  }
  return solve(system);
}

/** Solves equations whose last column is the right-hand side; they are positive definite. @param {number[][]} system */
function solve(system) {
  const size = system.length;
  for (const [i, pivot] of system.entries()) {
    for (const equation of system.slice(i + 1)) {
      const factor = (equation[i] ?? 0) / (pivot[i] ?? 1);
      for (let k = i; k <= size; k++) equation[k] = (equation[k] ?? 0) - factor * (pivot[k] ?? 0);
    }
  }
  /** @type {number[]} */
  const solution = new Array(size).fill(0);
  for (let i = size - 1; i >= 0; i--) {
    const equation = system[i] ?? [];
    const known = dot(equation.slice(i + 1, size), solution.slice(i + 1));
    solution[i] = ((equation[size] ?? 0) - known) / (equation[i] ?? 1);
  }
  return solution;
}

/**
 * The poses of cases to which the regression applies.
 * @param {string} name
 * @param {readonly string[]} cases arguments of the lab
 * @param {FitOptions} options
 * @param {string} [suffix] further options of the rows
 * @returns {Promise<Sample[]>}
 */
async function samplesOf(name, cases, { threads, keep }, suffix = "") {
  mkdirSync(keep, { recursive: true });
  const json = join(resolve(keep), `${name}.jsonl`);
  const rows = ROWS.flatMap((row) => ["--row", row + suffix]);
  await runLab(["bench", ...cases, ...rows, "--json", json, ...threadArguments(threads)]);
  const model = currentModel();
  return readResults(json).flatMap((result) => {
    const features = featuresOf(result, model);
    if (features === null || (result.strict === null && result.class !== "misfit")) return [];
    // The features here and those of the core are the same: they give the same confidence.
    const [expected, found] = [result.confidence ?? Number.NaN, probability(features, model)];
    if (!(Math.abs(found - expected) < 1e-9)) {
      const remedy = `Remedy: remove ${keep}, or make featuresOf() agree with src/precise/verdict/confidence.rs.`;
      throw new Error(`${result.name}: confidence ${expected}, but ${found} by the constants of the code. ${remedy}`);
    }
    return [{ result, features, isRight: result.strict === true && result.class !== "misfit" }];
  });
}

/** @param {string} name @param {number} cases @param {number} seed @param {FitOptions} options */
async function generated(name, cases, seed, options) {
  const all = [];
  for (const [kind, { set, part, suffix }] of Object.entries(SETS)) {
    const count = ["--count", `${Math.ceil(cases * part)}`, "--seed", `${seed}`];
    all.push(await samplesOf(`${name}-${kind}`, ["--set", set, ...count], options, suffix));
  }
  return all;
}

/**
 * The line with the intercept that fits best to groups of samples, each of which weighs the same: by Newton's method.
 * @param {Line} line
 * @param {readonly (readonly Sample[])[]} groups
 * @returns {Line}
 */
function withIntercept({ intercept, slopes }, groups) {
  for (let step = 0; step < MAX_STEPS; step++) {
    const line = { intercept, slopes };
    const sums = groups.map((samples) => {
      const all = samples.map(({ features, isRight }) => ({ p: probability(features, line), isRight }));
      return [mean(all.map(({ p, isRight }) => Number(isRight) - p)), mean(all.map(({ p }) => p * (1 - p)))];
    });
    const change = mean(sums.map(([slope]) => slope ?? 0)) / mean(sums.map(([, curvature]) => curvature ?? 1));
    intercept += Math.min(Math.max(change, -1), 1);
    if (Math.abs(change) < 1e-9) break;
  }
  return { intercept, slopes };
}

/** The samples of a folder whose truth is beyond doubt, and of which shape alone decides the turn. @param {readonly Sample[]} samples */
const decided = (samples) =>
  samples.filter(({ result, features }) => features[MARGIN] === 1 && (result.strict === true || result.loose !== true));

/** The Brier score and the logarithmic loss of a line: lower is better. @param {readonly Sample[]} all @param {Line} line */
function losses(all, line) {
  const confidences = all.map(({ features }) => Math.min(Math.max(probability(features, line), 1e-12), 1 - 1e-12));
  const brier = mean(confidences.map((p, i) => (p - Number(all[i]?.isRight)) ** 2));
  const logarithmic = mean(confidences.map((p, i) => -Math.log(all[i]?.isRight ? p : 1 - p)));
  return [fixed(brier, 4), fixed(logarithmic, 4)];
}

/** Poses by the confidence of a line. @param {readonly Sample[]} all @param {Line} line */
function reliabilityTable(all, line) {
  const results = all.map(({ result, features, isRight }) => ({
    ...{ ...result, strict: isRight },
    confidence: probability(features, line),
  }));
  return markdownTable(reliabilityHeads, reliability(results));
}

/** @param {FitOptions} options */
async function fit(options) {
  const groups = await generated("training", options.cases, options.seed, options);
  const training = groups.flat();
  const test = (await generated("test", options.testCases, options.testSeed, options)).flat();
  /** @type {Sample[][]} */
  const real = [];
  for (const [k, folder] of (options.real ?? []).entries()) {
    real.push(decided(await samplesOf(`real-${k}`, ["--cases", folder], options)));
  }
  const ofGenerated = fitLogistic(training);
  const line = real.length > 0 ? withIntercept(ofGenerated, [...groups, ...real]) : ofGenerated;
  // As many digits as the code has: what is measured is what can be copied.
  const digits = (/** @type {number} */ x) => x.toFixed(3);
  const fitted = { intercept: Number(digits(line.intercept)), slopes: line.slopes.map((x) => Number(digits(x))) };
  console.log(`
const INTERCEPT: f64 = ${digits(fitted.intercept)};
const SLOPES: [f64; ${fitted.slopes.length}] = [${fitted.slopes.map(digits).join(", ")}];
`);
  const lines = { fitted, "in the code": currentModel() };
  const table = Object.entries(lines).map(([name, each]) => [name, ...losses(training, each), ...losses(test, each)]);
  const head = ["constants", "training: Brier", "log loss", "test: Brier", "log loss"];
  console.log(`${markdownTable(head, table)}\n\n${training.length} poses for training, ${test.length} for the test.`);
  for (const [name, each] of Object.entries(lines)) {
    console.log(`\nTest cases, constants ${name}\n\n${reliabilityTable(test, each)}`);
  }
  for (const [k, folder] of (options.real ?? []).entries()) {
    const others = real.filter((_, other) => other !== k);
    const table = reliabilityTable(real[k] ?? [], withIntercept(ofGenerated, [...groups, ...others]));
    console.log(`\n${folder}, intercept of all others\n\n${table}`);
  }
}

await command("fit", (program) =>
  program
    .description("Fits the regression behind `confidence` to generated cases, and tests it on others.")
    .option("--cases <n>", "generated cases to fit to", count, 600)
    .option("--seed <s>", "their seed", Number, 5)
    .option("--test-cases <n>", "generated cases of the test", count, 240)
    .option("--test-seed <s>", "their seed", Number, 1)
    .option(
      "--real <folders...>",
      "folders of case folders with a truth, one for each sensor, to fit the intercept to as well",
    )
    .option("--threads <n>", "all by default", count)
    .option("--keep <folder>", "keep all results here; cases that are there are not run again", "target/bench/fit")
    .action(fit),
);
