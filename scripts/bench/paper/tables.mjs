/** The paper's tables over our records: which rows there are, and how they are printed. */
import { fixed, markdownTable, percent } from "../table.mjs";
import { columns, summarise, summariseTruth, typicalSeconds } from "./summary.mjs";

/** @typedef {import("../records.mjs").BenchRecord} BenchRecord */
/** @typedef {import("./summary.mjs").Summary} Summary */
/** @typedef {import("./rows.mjs").TableSpec} TableSpec */
/** @typedef {(prior: string, row: string) => readonly BenchRecord[]} RecordsOf of a prior and a row; none where it was not run */
/**
 * The paper's own figures: by table and row, means by column key, and `collapsed` and `clamped` as shares.
 * @typedef {Record<string, Record<string, Record<string, number | null>>>} PaperFigures
 */
/**
 * @typedef {object} TableRow
 * @property {string} name
 * @property {string} prior
 * @property {Partial<Summary>} summary
 * @property {Record<string, number | null> | null} paper
 */
/** @typedef {{ id: string, title: string, rows: TableRow[] }} Table */

/**
 * @param {readonly TableSpec[]} specs
 * @param {RecordsOf} recordsOf
 * @param {PaperFigures} paper
 * @returns {Table[]}
 */
export function makeTables(specs, recordsOf, paper) {
  return specs.map(({ id, title, rows, priors, truth }) => ({
    id,
    title,
    rows: priors.flatMap((prior) => {
      const measured = rows.map(({ name }) => ({ name, records: recordsOf(prior, name) }));
      /** @type {TableRow[]} */
      const lines = measured
        .filter(({ records }) => records.length > 0)
        .map(({ name, records }) => ({ name, prior, summary: summarise(records), paper: paper[id]?.[name] ?? null }));
      const first = measured.find(({ records }) => records.length > 0);
      if (truth && first !== undefined) {
        lines.push({ name: "(the true pose)", prior, summary: summariseTruth(first.records), paper: null });
      }
      return lines;
    }),
  }));
}

/**
 * The seconds of every row of every table, by table, prior and row.
 * @param {readonly Table[]} tables
 * @param {RecordsOf} recordsOf
 */
export function secondsOf(tables, recordsOf) {
  return Object.fromEntries(
    tables.map(({ id, rows }) => [
      id,
      Object.fromEntries(rows.map(({ prior, name }) => [`${prior}/${name}`, typicalSeconds(recordsOf(prior, name))])),
    ]),
  );
}

/**
 * A table as Markdown: every metric as mean (median), then what the truth says of the poses; lines of the paper's own
 * figures, where they are known, below those they belong to.
 * @param {Table} table
 * @param {Record<string, number | null>} seconds
 */
export function tableMarkdown({ rows }, seconds) {
  const priors = new Set(rows.map(({ prior }) => prior));
  const label = (/** @type {TableRow} */ { name, prior }) => (priors.size > 1 ? `${name}, ${prior} meshes` : name);
  const head = ["", ...columns.map(({ title }) => title), "strict %", "loose %", "scale %", "rotation °", "transl. %"];
  head.push("collapsed %", "clamped %", "s", "n");
  return markdownTable(
    head,
    rows.flatMap((row) => {
      const lines = [[label(row), ...cells(row.summary, seconds[`${row.prior}/${row.name}`])]];
      if (row.paper) lines.push([`${label(row)} (paper)`, ...paperCells(row.paper)]);
      return lines;
    }),
  );
}

/** @param {number | null | undefined} value */
const percentOf = (value) => (value === null || value === undefined ? "–" : percent(value));

/** @param {Partial<Summary>} summary @param {number | null | undefined} seconds */
function cells({ n = 0, answered = 0, metrics = {}, success, errors, collapsed, clamped }, seconds) {
  return [
    ...columns.map(({ key, digits }) => {
      const { mean, median } = metrics[key] ?? {};
      return `${fixed(mean, digits)} (${fixed(median, digits)})`;
    }),
    ...[percentOf(success?.strict), percentOf(success?.loose)],
    ...[percentOf(errors?.scale), fixed(errors?.rotationDeg, 1), percentOf(errors?.translation)],
    ...[percentOf(collapsed), percentOf(clamped), fixed(seconds, 2)],
    answered === n ? `${n}` : `${answered} of ${n}`,
  ];
}

/** @param {Record<string, number | null>} figures */
function paperCells(figures) {
  const dashes = Array.from({ length: 5 }, () => "–");
  const metrics = columns.map(({ key, digits }) => fixed(figures[key], digits));
  return [...metrics, ...dashes, percentOf(figures.collapsed), percentOf(figures.clamped), "–", "–"];
}
