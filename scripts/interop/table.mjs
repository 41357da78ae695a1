/** Writes the results of a run to the repository: the tables of the guide, a list of all cells, and the fixtures. */
import { copyFileSync, mkdirSync, rmSync, writeFileSync } from "node:fs";
import { extname, join } from "node:path";
import { at } from "../lib/paths.mjs";
import { rewrite } from "../lib/rewrite.mjs";
import { data } from "./cells.mjs";

/** @typedef {import("./cells.mjs").Cell} Cell */

/** Values in groups, by a key. @template T @param {readonly T[]} all @param {(each: T) => string} key @returns {[string, T[]][]} */
function grouped(all, key) {
  const keys = [...new Set(all.map(key))];
  return keys.map((name) => [name, all.filter((each) => key(each) === name)]);
}

/** Counts by kind: "mesh 12, depth 3". @param {readonly Cell[]} cells */
const counts = (cells) =>
  grouped(cells, ({ kind }) => kind)
    .map(([kind, all]) => `${kind} ${all.length}`)
    .join(", ");

/** The largest difference of cells in metres, as millimetres. @param {readonly Cell[]} cells */
function largest(cells) {
  const errors = cells.flatMap(({ error, unit }) => (unit === "m" && error !== undefined ? [1000 * error] : []));
  const most = Math.max(...errors);
  if (errors.length === 0) return "";
  return most < 1e-4 ? "< 0.0001" : `${Number(most.toPrecision(1))}`;
}

/** Puts a table between the markers of the guide. @param {string} mark @param {readonly string[][]} rows */
const writeBetween = (mark, rows, above = "") =>
  rewrite([at("docs", "guides", "interoperability.md")], (text) => {
    const marked = new RegExp(`(<!-- ${mark} -->\\n)[\\s\\S]*(<!-- /${mark} -->)`);
    const [head = "", ...others] = rows.map((row) => `| ${row.join(" | ")} |`);
    const line = `|${"---|".repeat(rows[0]?.length ?? 0)}`;
    return text.replace(marked, (_, start, end) => `${start}\n${above}${[head, line, ...others].join("\n")}\n\n${end}`);
  });

/** Shows what the places are about. */
const picture =
  "![Four differences: the centre of the first pixel is 0 or 0.5; depth is along the axis or along the ray; a depth map at half its size has readings between surfaces; a box is along the axes or the smallest](../pictures/interoperability.svg)";

/** Writes the table of the places where programs differ. @param {readonly Cell[]} cells */
export function writePlaces(cells) {
  const rows = Object.entries(data("places")).map(([key, { question, decision }]) => {
    const own = cells.filter(({ kind }) => kind === key);
    // Versions with the same answer are in one line.
    const answers = grouped(own, ({ program, variant, result }) => `${program}|, ${variant}: ${result}`);
    const lines = answers.map(([answer, all]) =>
      answer.replace("|", ` ${all.map(({ version }) => version).join(" and ")}`),
    );
    return [question, lines.join("<br>"), decision];
  });
  writeBetween("places", [["question", "answers", "what to do"], ...rows], `${picture}\n\n`);
}

/** Writes the table of programs, and all cells. @param {readonly Cell[]} cells @param {string} date */
export function writeTable(cells, date) {
  const notes = data("notes");
  const name = (/** @type {Cell} */ { program, version }) => `${program} ${version}`;
  const programs = grouped(
    cells.filter(({ action }) => action !== "place"),
    name,
  );
  programs.sort(([a], [b]) => a.localeCompare(b, "en", { sensitivity: "base", numeric: true }));
  const rows = programs.map(([each, own]) => {
    const written = own.filter(({ action }) => action === "write");
    const isRefused = (/** @type {Cell} */ { passed, result }) => passed && result.startsWith("refused");
    const refused = grouped(written.filter(isRefused), ({ variant }) => variant).map(([variant]) => variant);
    const read = counts(written.filter((cell) => !isRefused(cell)));
    const texts = [read, refused.length > 0 ? `named, not read: ${refused.join(", ")}` : ""].filter(Boolean);
    const loaded = counts(own.filter(({ action }) => action === "load"));
    const note = [notes[own[0]?.program ?? ""], notes[each]].filter(Boolean).join(" ");
    return [each, texts.join("; "), loaded, largest(own), note];
  });
  const misses = cells.filter(({ passed }) => !passed).length;
  const outcome = misses === 0 ? "all as stated" : `${misses} not as stated`;
  const head = [
    "program",
    "what it writes, read by sim3align",
    "what it loads of sim3align",
    "largest difference, mm",
    "what to know",
  ];
  const above = `Measured on ${date}: ${cells.length} cells, ${outcome}; [every cell](../record/interop.tsv).\n\n`;
  writeBetween("interop", [head, ...rows], above);
  const lines = cells.map((cell) => {
    const short = cell.result.replace(/\s+/g, " ").replaceAll(at(), "").slice(0, 160);
    return [name(cell), cell.action, cell.kind, cell.variant, cell.passed ? "as stated" : "MISS", short].join("\t");
  });
  const text = `program\taction\tkind\tvariant\toutcome\tdifference\n${lines.sort().join("\n")}\n`;
  writeFileSync(at("docs", "record", "interop.tsv"), text);
}

/** Copies some of the written files to the tests, with what is expected of them. @param {readonly any[]} rows */
export function writeFixtures(rows) {
  const folder = at("tests", "fixtures", "interop");
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  const index = data("fixtures").map((/** @type {string} */ title) => {
    const row = rows.find(({ program, version, variant }) => title === `${program} ${version}: ${variant}`);
    if (row === undefined) throw new Error(`No program wrote the fixture ${title}`);
    const { program, version, kind, variant, expect } = row;
    const file = `${kind}-${title.toLowerCase().replace(/[^a-z0-9.]+/g, "-")}${extname(row.file)}`;
    copyFileSync(row.file, join(folder, file));
    return { program, version, kind, variant, file, expect };
  });
  writeFileSync(join(folder, "index.json"), `${JSON.stringify(index, null, 2)}\n`);
}
