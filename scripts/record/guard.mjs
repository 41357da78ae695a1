/** The losses of a new record against an older one on the same cases: accuracy beyond chance, work, size. */
import { median } from "../bench/table.mjs";

/** A loss counts if chance alone would show it in fewer than one of twenty comparisons… */
const SIGNIFICANT = 0.05;
/** …and it is at least this share of the cases, or of the error. */
const NOTABLE = 0.01;
/** Growth of the work of a search, and of a module, from which on it is a loss. */
const WORK = 0.05;
const SIZE = 0.01;

const errorNames = ["scale", "rotation", "place"];
const kinds = /** @type {const} */ (["strict", "loose"]);

/**
 * A result as the quick record keeps it.
 * @typedef {object} Line
 * @property {string} row
 * @property {string} case
 * @property {boolean} strict
 * @property {boolean} loose
 * @property {readonly (number | null)[] | null} errors
 */
/**
 * @typedef {object} QuickRecord
 * @property {string} version
 * @property {Readonly<Record<string, number>>} sizes bytes of the modules, gzipped
 * @property {readonly { set: string, work: Work, lines: readonly Line[] }[]} sets
 */
/** @typedef {Readonly<Record<string, Readonly<Record<string, number>>>>} Work sums of the counts, by row and name */
/** @typedef {readonly (readonly [before: Line, after: Line])[]} Pairs */

/**
 * The losses, in words; none if the new record is as good.
 * @param {QuickRecord} before
 * @param {QuickRecord} after
 * @returns {string[]}
 */
export function losses(before, after) {
  const found = [];
  /** Pairs of each case of all sets, of as many rows as it has. @type {Pairs[number][][]} */
  const cases = [];
  for (const { set, work, lines } of before.sets) {
    const other = after.sets.find((found) => found.set === set);
    found.push(...grown(set, work, other?.work));
    const now = new Map(other?.lines.map((line) => [key(line), line]));
    const pairs = lines.flatMap((line) => {
      const other = now.get(key(line));
      return other === undefined ? [] : [/** @type {const} */ ([line, other])];
    });
    if (pairs.length < lines.length)
      found.push(`${set}: ${lines.length - pairs.length} of ${lines.length} cases are missing`);
    for (const row of new Set(lines.map((line) => line.row))) {
      found.push(
        ...lossesOf(
          `${set}, ${row}`,
          pairs.filter(([line]) => line.row === row),
        ),
      );
    }
    for (const name of new Set(lines.map((line) => line.case))) {
      cases.push(pairs.filter(([line]) => line.case === name));
    }
  }
  // Too few of one set show a loss of some per cent; together they do. Rows of a case go together, so that each case counts
  // once.
  for (const kind of kinds) {
    const changes = cases.map((pairs) => Math.sign(pairs.reduce((sum, pair) => sum + changeOf(pair, kind), 0)));
    found.push(...lostCases("all sets", kind, changes));
  }
  for (const [name, bytes] of Object.entries(before.sizes)) {
    const now = after.sizes[name] ?? 0;
    if (now > bytes * (1 + SIZE)) found.push(`size of ${name}: ${bytes} -> ${now} bytes`);
  }
  return found;
}

const key = (/** @type {Line} */ line) => `${line.row}\n${line.case}`;

/** @param {string} name @param {Pairs} pairs @returns {string[]} */
function lossesOf(name, pairs) {
  const found = kinds.flatMap((kind) =>
    lostCases(
      name,
      kind,
      pairs.map((pair) => changeOf(pair, kind)),
    ),
  );
  for (const [i, error] of errorNames.entries()) {
    const ratios = pairs.flatMap(([before, after]) =>
      before.errors && after.errors ? [Math.log((after.errors[i] || 1e-9) / (before.errors[i] || 1e-9))] : [],
    );
    const chance = signedRankTest(ratios);
    const growth = Math.exp(median(ratios.filter((ratio) => ratio !== 0))) - 1;
    if (growth >= NOTABLE && chance < SIGNIFICANT) {
      found.push(`${name}: the error of ${error} grows by ${(100 * growth).toFixed(1)} % in the median${odds(chance)}`);
    }
  }
  return found;
}

/** @param {string} set @param {Work} before @param {Work | undefined} after @returns {string[]} */
const grown = (set, before, after) =>
  Object.entries(before).flatMap(([row, counts]) =>
    Object.entries(counts).flatMap(([name, count]) => {
      const ratio = (after?.[row]?.[name] ?? 0) / count;
      return ratio > 1 + WORK ? [`${set}, ${row}: ${ratio.toFixed(2)} times as many ${name}`] : [];
    }),
  );

/** 1 for a loss, -1 for a gain. @param {Pairs[number]} pair @param {typeof kinds[number]} kind */
const changeOf = ([before, after], kind) => Number(before[kind]) - Number(after[kind]);

/**
 * @param {string} name
 * @param {typeof kinds[number]} kind
 * @param {readonly number[]} changes of the cases
 */
function lostCases(name, kind, changes) {
  const [lost, won] = [1, -1].map((change) => changes.filter((other) => other === change).length);
  const chance = signTest(lost ?? 0, won ?? 0);
  if ((lost ?? 0) - (won ?? 0) < NOTABLE * changes.length || chance >= SIGNIFICANT) return [];
  return [`${name}: ${lost} of ${changes.length} are no longer within ${kind}, ${won} newly are${odds(chance)}`];
}

const odds = (/** @type {number} */ chance) => `, by chance in ${(100 * chance).toFixed(2)} % of comparisons`;

/**
 * Probability of at least `losses` among so many changes, if gains and losses are equally likely.
 * @param {number} lost
 * @param {number} won
 */
function signTest(lost, won) {
  const all = lost + won;
  // Logarithms, because the coefficients of many cases overflow.
  let term = -all * Math.LN2;
  let sum = 0;
  for (let k = 0; k <= all; k++) {
    if (k >= lost) sum += Math.exp(term);
    term += Math.log(all - k) - Math.log(k + 1);
  }
  return Math.min(1, sum);
}

/**
 * Probability that differences whose signs were random would have at least this rank sum of the positive ones (Wilcoxon's
 * signed ranks, by the normal approximation, without the cases that did not change).
 * @param {readonly number[]} differences
 */
function signedRankTest(differences) {
  const changed = differences.filter((d) => d !== 0).sort((a, b) => Math.abs(a) - Math.abs(b));
  const n = changed.length;
  if (n === 0) return 1;
  let positive = 0;
  let variance = 0;
  for (let i = 0; i < n; ) {
    let end = i;
    while (end < n && Math.abs(changed[end] ?? 0) === Math.abs(changed[i] ?? 0)) end++;
    // Equal differences share the mean of their ranks.
    const rank = (i + 1 + end) / 2;
    for (; i < end; i++) {
      positive += (changed[i] ?? 0) > 0 ? rank : 0;
      variance += rank * rank;
    }
  }
  return normalTail((positive - (n * (n + 1)) / 4 - 0.5) / Math.sqrt(variance / 4));
}

/** Probability above z of the normal distribution (Abramowitz and Stegun, 26.2.17; error below 1e-7). @param {number} z @returns {number} */
function normalTail(z) {
  if (z < 0) return 1 - normalTail(-z);
  const t = 1 / (1 + 0.2316419 * z);
  const poly = [0.31938153, -0.356563782, 1.781477937, -1.821255978, 1.330274429].reduceRight((s, c) => (s + c) * t, 0);
  return (poly * Math.exp((-z * z) / 2)) / Math.sqrt(2 * Math.PI);
}
