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
  for (const kind of /** @type {const} */ (["strict", "loose"])) {
    const lost = pairs.filter(([before, after]) => before[kind] && !after[kind]).length;
    const won = pairs.filter(([before, after]) => !before[kind] && after[kind]).length;
    const chance = signTest(lost, won);
    if (lost - won >= NOTABLE * pairs.length && chance < SIGNIFICANT) {
      found.push(`${name}: ${lost} of ${pairs.length} are no longer within ${kind}, ${won} newly are${odds(chance)}`);
    }
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

const odds = (/** @type {number} */ chance) => `, by chance in ${(100 * chance).toFixed(2)} % of comparisons`;
