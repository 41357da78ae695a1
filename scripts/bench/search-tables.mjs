/** Tables over generated cases: the parts of the search, the reliability of confidence, and the kinds of failures. */
import { failureCounts, isWithin, judged, loose, strict, tiersOf, typicalError } from "./records.mjs";
import { fixed, markdownTable, mean, median, percent, share } from "./table.mjs";

/** @typedef {import("./records.mjs").BenchRow} BenchRow */
/** @typedef {import("./records.mjs").BenchRecord} BenchRecord */

/**
 * Success of all cases and by tier, and what is typical of the errors, per set of options.
 * @param {readonly BenchRow[]} rows
 */
export function ablationTable(rows) {
  const tiers = tiersOf(judged(rows[0]?.records ?? []));
  const head = [
    "strict / loose %",
    "all",
    ...tiers,
    "scale %",
    "rotation °",
    "transl. %",
    "IoU",
    "s",
    "search f.",
    "scoring f.",
  ];
  return markdownTable(
    head,
    rows.map(({ row, records }) => [row, ...ablationCells(judged(records), tiers)]),
  );
}

/** @param {readonly BenchRecord[]} records @param {readonly string[]} tiers */
function ablationCells(records, tiers) {
  const groups = [records, ...tiers.map((tier) => records.filter((record) => record.tier === tier))];
  const error = (/** @type {keyof import("./records.mjs").PoseErrors} */ name) => typicalError(records, name);
  const overlaps = records.flatMap(({ alignment }) => alignment?.metrics.iou ?? []);
  const { search, scoring } = failureCounts(records);
  return [
    ...groups.map((group) => [strict, loose].map((tolerance) => successPercent(group, tolerance)).join(" / ")),
    ...[fixed(100 * error("scaleError"), 2), fixed(error("rotationErrorDeg"), 2)],
    ...[fixed(100 * error("translationErrorRelative"), 2), fixed(mean(overlaps), 3)],
    ...[fixed(median(records.map(({ seconds }) => seconds)), 2), search, scoring],
  ];
}

/** @param {readonly BenchRecord[]} records @param {typeof strict} tolerance */
const successPercent = (records, tolerance) => percent(share(records.map(({ errors }) => isWithin(errors, tolerance))));

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
    ...members.map((group, i) => reliabilityLine(names[i] ?? "", group, records.length)),
    ...tiersOf(records).map((tier) => {
      const isOf = (/** @type {BenchRecord} */ record) => record.tier === tier;
      return reliabilityLine(`${names.at(-1)}, ${tier}`, surest.filter(isOf), records.filter(isOf).length);
    }),
    reliabilityLine("all", records, records.length),
  ];
  return markdownTable(["confidence", "n", "share %", "mean confidence", "right %"], rows);
}

/** @param {string} name @param {readonly BenchRecord[]} group @param {number} of */
function reliabilityLine(name, group, of) {
  const confidence = mean(group.map((record) => confidenceOf(record) ?? 0));
  const right = share(group.map(({ errors }) => isWithin(errors, strict)));
  return [name, group.length, percent(group.length / of), fixed(confidence, 3), percent(right)];
}

/** A rotation error from which on a pose is off by a turn, degrees. */
const turnDeg = 45;

/**
 * How often the alternatives hold the true pose where the pose is off by a turn, and how many alternatives poses have.
 * @param {readonly BenchRecord[]} all
 */
export function alternativesTable(all) {
  const records = judged(all).filter(({ alignment }) => alignment !== null);
  const turned = records.filter(({ errors }) => (errors?.rotationErrorDeg ?? 0) > turnDeg);
  const placed = turned.filter(({ errors }) => isWithin(errors, { ...loose, rotationDeg: 180 }));
  const groups = /** @type {const} */ ([
    ["all", records],
    ["within tolerance (loose)", records.filter(({ errors }) => isWithin(errors, loose))],
    [`rotation off by more than ${turnDeg}°`, turned],
    ["of these, size and position within tolerance (loose)", placed],
  ]);
  const rows = groups.map(([name, group]) => {
    const lists = group.map(({ alignment }) => alignment?.alternatives?.length ?? 0);
    const listed = (/** @type {"rightAlternative" | "nearAlternative"} */ which) =>
      group === turned || group === placed ? group.filter((record) => record[which] !== null).length : "";
    return [name, group.length, listed("rightAlternative"), listed("nearAlternative"), fixed(mean(lists), 2)];
  });
  return markdownTable(["poses", "n", "true pose listed, strict", "loose", "mean number of alternatives"], rows);
}

/**
 * Wrong poses by the kind of failure, in all and by tier.
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
