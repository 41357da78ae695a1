/** Whether poses are right as often as their confidence says. */
import { failureCounts, judged, tiersOf } from "./records.mjs";
import { mean, share } from "./statistics.mjs";
import { fixed, markdownTable, percent } from "./table.mjs";
import { isWithin, strict } from "./tolerance.mjs";

/** @typedef {import("./records.mjs").BenchRecord} BenchRecord */

/** Where the bins begin; the last one is what callers trust. */
const bins = [0, 0.5, 0.7, 0.9];

/** @param {BenchRecord} record */
const confidenceOf = ({ alignment }) => alignment?.confidence ?? null;

/**
 * The index of the bin that a confidence falls in.
 * @param {number} confidence
 */
export const binOf = (confidence) => bins.filter((least) => confidence >= least).length - 1;

/**
 * Poses by confidence: how many, how sure, how often right; of the surest, by tier too.
 * @param {readonly BenchRecord[]} all
 */
export function reliabilityTable(all) {
  const records = judged(all).filter((record) => confidenceOf(record) !== null);
  const members = bins.map((_, bin) => records.filter((record) => binOf(confidenceOf(record) ?? 0) === bin));
  const surest = members.at(-1) ?? [];
  const names = bins.map((least, i) => (i + 1 < bins.length ? `${least} to ${bins[i + 1]}` : `${least} and above`));
  const rows = [
    ...members.map((group, i) => line(names[i] ?? "", group, records.length)),
    ...tiersOf(records).map((tier) => {
      const isOf = (/** @type {BenchRecord} */ record) => record.tier === tier;
      return line(`${names.at(-1)}, ${tier}`, surest.filter(isOf), records.filter(isOf).length);
    }),
    line("all", records, records.length),
  ];
  return markdownTable(["confidence", "n", "share %", "mean confidence", "right %"], rows);
}

/** @param {string} name @param {readonly BenchRecord[]} group @param {number} of */
function line(name, group, of) {
  const confidence = mean(group.map((record) => confidenceOf(record) ?? 0));
  const right = share(group.map(({ errors }) => isWithin(errors, strict)));
  return [name, group.length, percent(group.length / of), fixed(confidence, 3), percent(right)];
}

/**
 * Wrong poses by whose fault they are, in all and by tier.
 * @param {readonly BenchRecord[]} all
 */
export function failureTable(all) {
  const records = judged(all);
  const groups = [["all", records], ...tiersOf(records).map((tier) => [tier, records.filter((r) => r.tier === tier)])];
  const rows = /** @type {[string, BenchRecord[]][]} */ (groups).map(([name, group]) => {
    const { search, scoring, unanswered, unknown } = failureCounts(group);
    return [name, group.length, search + scoring + unanswered + unknown, search, scoring, unanswered];
  });
  return markdownTable(["cases", "n", "wrong", "search failure", "scoring failure", "unanswered"], rows);
}
