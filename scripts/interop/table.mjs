/** What a run leaves in the repository: the table of the guide, a row for each program and version, all cells, and fixtures. */
import { copyFileSync, mkdirSync, rmSync, statSync, writeFileSync } from "node:fs";
import { extname, join } from "node:path";
import { at } from "../lib/paths.mjs";
import { rewrite } from "../lib/rewrite.mjs";
import { data } from "./cells.mjs";

/** @typedef {import("./cells.mjs").Cell & { passed: boolean, result: string }} Cell */

/** Counts by kind: "mesh 12, depth 3". @param {readonly Cell[]} cells */
function counts(cells) {
  const kinds = [...new Set(cells.map(({ kind }) => kind))];
  const texts = kinds.map((kind) => {
    const all = cells.filter((cell) => cell.kind === kind);
    const passed = all.filter((cell) => cell.passed).length;
    return `${kind} ${passed === all.length ? all.length : `${passed} of ${all.length}`}`;
  });
  return texts.join(", ");
}

/** The largest difference of cells in metres, as millimetres. @param {readonly Cell[]} cells */
function largest(cells) {
  const errors = cells.flatMap(({ error, unit }) => (unit === "m" && error !== undefined ? [1000 * error] : []));
  const most = Math.max(...errors);
  if (errors.length === 0) return "";
  if (most < 1e-4) return "< 0.0001";
  return most < 0.01 ? `${Number(most.toPrecision(1))}` : most.toFixed(2);
}

/** Puts content between the markers of the guide. @param {string} mark @param {string} content */
const writeBetween = (mark, content) =>
  rewrite([at("docs", "guides", "interoperability.md")], (text) => {
    const marked = new RegExp(`(<!-- ${mark} -->\\n)[\\s\\S]*(<!-- /${mark} -->)`);
    return text.replace(marked, (_, start, end) => `${start}\n${content}\n\n${end}`);
  });

/** Shows what the places are about. */
const picture =
  "![Four differences: the centre of the first pixel is 0 or 0.5; depth is along the axis or along the ray; a depth map at half its size has readings between surfaces; a box is along the axes or the smallest](../pictures/interoperability.svg)";

/** Writes the table of the places where programs differ. @param {readonly Cell[]} cells */
export function writePlaces(cells) {
  const rows = Object.values(data("places")).map(({ question, decision }) => {
    const own = cells.filter(({ action, kind }) => action === "place" && kind === question);
    // Versions with the same answer are in one line.
    /** @type {Map<string, string[]>} */
    const versions = new Map();
    for (const { program, version, variant, result } of own) {
      const answer = `${program}|, ${variant}: ${result}`;
      versions.set(answer, [...(versions.get(answer) ?? []), version]);
    }
    const lines = Array.from(versions, ([answer, all]) => answer.replace("|", ` ${all.join(" and ")}`));
    return `| ${question} | ${lines.join("<br>")} | ${decision} |`;
  });
  writeBetween("places", `${picture}\n\n| question | answers | what to do |\n|---|---|---|\n${rows.join("\n")}`);
}

/** Writes the table of programs. @param {readonly Cell[]} cells @param {string} date */
export function writeTable(cells, date) {
  const notes = data("notes");
  const name = (/** @type {Cell} */ { program, version }) => `${program} ${version}`;
  const names = [...new Set(cells.filter(({ action }) => action !== "place").map(name))].sort((a, b) =>
    a.localeCompare(b, "en", { sensitivity: "base", numeric: true }),
  );
  const rows = names.map((each) => {
    const own = cells.filter((cell) => name(cell) === each);
    const written = own.filter(({ action }) => action === "write");
    const isRefused = (/** @type {Cell} */ { passed, result }) => passed && result.startsWith("refused");
    const refused = [...new Set(written.filter(isRefused).map(({ variant }) => variant))];
    const read = counts(written.filter((cell) => !isRefused(cell)));
    const texts = [read, refused.length > 0 ? `named, not read: ${refused.join(", ")}` : ""].filter(Boolean);
    const loaded = own.filter(({ action }) => action === "load");
    const note = [notes[own[0]?.program ?? ""], notes[each]].filter(Boolean).join(" ");
    return `| ${each} | ${texts.join("; ")} | ${counts(loaded)} | ${largest(own)} | ${note} |`;
  });
  const misses = cells.filter(({ passed }) => !passed).length;
  const total = `Measured on ${date}: ${cells.length} cells, ${misses === 0 ? "all as stated" : `${misses} not as stated`}; [every cell](../record/interop.tsv).`;
  const head =
    "| program | what it writes, read by sim3align | what it loads of sim3align | largest difference, mm | what to know |\n|---|---|---|---|---|";
  writeBetween("interop", `${total}\n\n${head}\n${rows.join("\n")}`);
  const lines = cells.map((cell) => {
    const short = cell.result.replace(/\s+/g, " ").replaceAll(at(), "").slice(0, 160);
    return [name(cell), cell.action, cell.kind, cell.variant, cell.passed ? "as stated" : "MISS", short].join("\t");
  });
  writeFileSync(
    at("docs", "record", "interop.tsv"),
    `program\taction\tkind\tvariant\toutcome\tdifference\n${lines.sort().join("\n")}\n`,
  );
}

/** Bytes of a fixture at most. */
const MOST = 20_480;

/** Copies some of the written files to the tests, with what is expected of them. @param {readonly any[]} rows */
export function writeFixtures(rows) {
  const folder = at("tests", "fixtures", "interop");
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  const index = data("fixtures").map((/** @type {string} */ title) => {
    const row = rows.find(({ program, version, variant }) => title === `${program} ${version}: ${variant}`);
    if (row === undefined) throw new Error(`No program wrote the fixture ${title}`);
    const { program, version, kind, variant, file, expect } = row;
    const name = `${kind}-${`${program}-${version} ${variant}`.toLowerCase().replace(/[^a-z0-9.]+/g, "-")}${extname(file)}`;
    if (statSync(file).size > MOST) throw new Error(`The fixture ${title} is too large`);
    copyFileSync(file, join(folder, name));
    return { program, version, kind, variant, file: name, expect };
  });
  writeFileSync(join(folder, "index.json"), `${JSON.stringify(index, null, 2)}\n`);
}
