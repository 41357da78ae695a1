/** What a new record has lost against an older one on the same cases: accuracy beyond chance, work, size. */
import { mean, median } from "../bench/table.mjs";
import { signedRankTest, signTest } from "./paired.mjs";

/** A loss counts if chance alone would show it in fewer than one of twenty comparisons… */
const SIGNIFICANT = 0.05;
/** …and it is at least this share of the cases, or of the error. */
const NOTABLE = 0.01;
/** Growth of the work of a search, and of a module, from which on it is a loss. */
const WORK = 0.05;
const SIZE = 0.01;

const errorNames = ["scale", "rotation", "place"];

/**
 * @typedef {object} QuickRecord
 * @property {string} version
 * @property {Readonly<Record<string, number>>} sizes bytes of the modules, gzipped
 * @property {readonly { set: string, lines: readonly import("./sets.mjs").Line[] }[]} sets
 */

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
  for (const { set, lines } of before.sets) {
    const now = new Map(after.sets.find((other) => other.set === set)?.lines.map((line) => [key(line), line]));
    const pairs = lines.flatMap((line) => {
      const other = now.get(key(line));
      return other === undefined ? [] : [/** @type {const} */ ([line, other])];
    });
    if (pairs.length < lines.length)
      found.push(`${set}: ${lines.length - pairs.length} of ${lines.length} cases are missing`);
    for (const row of new Set(lines.map((line) => line.row))) {
      const of = pairs.filter(([line]) => line.row === row);
      found.push(...lossesOf(`${set}, ${row}`, of));
    }
    for (const name of new Set(lines.map((line) => line.case))) {
      cases.push(pairs.filter(([line]) => line.case === name));
    }
  }
  // Too few of one set show a loss of some per cent; together they do. Rows of a case go together, so that each case counts once.
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

const key = (/** @type {import("./sets.mjs").Line} */ line) => `${line.row}\n${line.case}`;

/** @typedef {readonly (readonly [before: import("./sets.mjs").Line, after: import("./sets.mjs").Line])[]} Pairs */

/** @param {string} name @param {Pairs} pairs @returns {string[]} */
function lossesOf(name, pairs) {
  const found = [];
  for (const kind of kinds) {
    const changes = pairs.map((pair) => changeOf(pair, kind));
    found.push(...lostCases(name, kind, changes));
  }
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
  const [before, after] = [0, 1].map((i) => mean(pairs.map((pair) => pair[i]?.work ?? 0)));
  if ((after ?? 0) > (before ?? 0) * (1 + WORK)) {
    found.push(`${name}: ${before?.toFixed(0)} -> ${after?.toFixed(0)} renders a case`);
  }
  return found;
}

const kinds = /** @type {const} */ (["strict", "loose"]);

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
