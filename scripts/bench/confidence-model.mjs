/** The regression behind `confidence`: its features from records, its constants, and the fit. */
import { readFileSync } from "node:fs";
import { at } from "../lib/paths.mjs";

/** @typedef {import("./records.mjs").BenchRecord} BenchRecord */
/** @typedef {{ intercept: number, slopes: readonly number[] }} Line in the space of the features */
/** @typedef {[low: number, high: number]} Limits */
/** @typedef {Line & { noise: number, scale: Limits, rotationDeg: Limits }} Model */

/** Weight of the penalty on slopes, which keeps them finite where the features separate right from wrong. */
const PENALTY = 1e-3;
const MAX_STEPS = 100;

/** The constants of the sources, which are declared there alone. @returns {Model} */
export function currentModel() {
  const read = (/** @type {string} */ file) => readFileSync(at("src", "precise", file), "utf8");
  const numbers = (/** @type {string} */ source, /** @type {string} */ name) => {
    const value = new RegExp(`const ${name}: [^=]+= \\[?([^\\];]+)`).exec(source)?.[1];
    if (value === undefined) throw new Error(`src/precise declares no ${name}. Remedy: correct ${import.meta.url}.`);
    return value.split(",").map(Number);
  };
  const [confidence, score] = [read("judged/confidence.rs"), read("scored/score.rs")];
  const limits = (/** @type {string} */ name) => /** @type {Limits} */ (numbers(confidence, name));
  return {
    intercept: numbers(confidence, "INTERCEPT")[0] ?? Number.NaN,
    slopes: numbers(confidence, "SLOPES"),
    // A 32-bit number there.
    noise: Math.fround(numbers(score, "NOISE")[0] ?? Number.NaN),
    scale: limits("SCALE"),
    rotationDeg: limits("ROTATION_DEG"),
  };
}

/**
 * The features of a pose; null where there is none that the regression applies to.
 * @param {BenchRecord} record
 * @param {Model} model
 */
export function featuresOf({ alignment }, { noise, scale, rotationDeg }) {
  const { diagnostics, uncertainty, alternatives } = alignment ?? {};
  const { score, terms } = diagnostics ?? {};
  if (score === undefined || !terms || !uncertainty || !alternatives) return null;
  const margin = Math.min(noise, ...alternatives.map((other) => score - other.score));
  const log = (/** @type {number} */ x, /** @type {Limits} */ [low, high]) =>
    Math.log(Math.min(Math.max(x, low), high));
  return [
    ...[terms.overlap, terms.depth, terms.outline, Math.max(margin, 0) / noise],
    ...[log(uncertainty.scale, scale), log(uncertainty.rotationDeg, rotationDeg)],
  ];
}

/** @param {readonly number[]} a @param {readonly number[]} b */
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * (b[i] ?? 0), 0);

/** @param {readonly number[]} features @param {Line} line */
export const probability = (features, { intercept, slopes }) => 1 / (1 + Math.exp(-dot(features, slopes) - intercept));

/**
 * Logistic regression by Newton's method, on features of mean 0 and variance 1. The same rows give the same line.
 * @param {readonly (readonly number[])[]} rows
 * @param {readonly boolean[]} labels
 * @returns {Line}
 */
export function fitLogistic(rows, labels) {
  const [first = []] = rows;
  const columns = first.map((_, j) => rows.map((row) => row[j] ?? Number.NaN));
  const means = columns.map((column) => column.reduce((sum, x) => sum + x, 0) / rows.length);
  const deviations = columns.map(
    (column, j) => Math.sqrt(column.reduce((sum, x) => sum + (x - (means[j] ?? 0)) ** 2, 0) / rows.length) || 1,
  );
  const standard = rows.map((row) => [1, ...row.map((x, j) => (x - (means[j] ?? 0)) / (deviations[j] ?? 1))]);
  let weights = new Array(first.length + 1).fill(0);
  for (let step = 0; step < MAX_STEPS; step++) {
    const change = newtonStep(standard, labels, weights);
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
    const p = 1 / (1 + Math.exp(-dot(row, weights)));
    const gradient = Number(labels[i]) - p;
    for (const [j, equation] of system.entries()) {
      const x = row[j] ?? 0;
      for (let k = 0; k < size; k++) equation[k] = (equation[k] ?? 0) + p * (1 - p) * x * (row[k] ?? 0);
      equation[size] = (equation[size] ?? 0) + gradient * x;
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
    solution[i] =
      ((equation[size] ?? 0) - dot(equation.slice(i + 1, size), solution.slice(i + 1))) / (equation[i] ?? 1);
  }
  return solution;
}
