/** The figures of the record in documents: rows of tables with its columns, by their first cell, and the table of confidences. */
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { filesBelow } from "../lib/cache.mjs";
import { at } from "../lib/paths.mjs";
import { holdUpToDate, rewrite } from "../lib/rewrite.mjs";
import { recordPicture } from "./picture.mjs";

/** The page of the record, and its picture. */
export const recordFile = at("docs", "record.md");
const pictureFile = at("docs", "record", "accuracy.svg");

const files = () => [
  ...[at("README.md"), at("docs", "benchmark.md")],
  ...filesBelow([at("docs", "guides")]).filter((path) => path.endsWith(".md")),
];

/** The first cells of rows in documents, and the set and row of the record that they stand for. @type {Record<string, string>} */
const titles = {
  ...{ "one object": "general | align", "depth sensors": "sensors | align", "objects of a scene": "scenes | together" },
  ...{ "coloured, with a photo": "colors | align", "frames of a video": "videos | all masks" },
  ...{ "by shape": "colors | shape alone", "with colour": "colors | align" },
  ...{ "desks, alone": "scenes | alone", "desks, together": "scenes | together" },
  ...{ "affine-invariant depth": "models | affine", "affine-invariant disparity": "models | disparity" },
  "metric depth, no camera": "models | no-camera",
  "affine-invariant disparity, no camera": "models | disparity-no-camera",
  ...{ "with placements, alone": "placements | alone", "with placements, together": "placements | together" },
};

/** The number of figures in rows of documents: from the number of cases to the confident ones. */
const FIGURES = 7;
const row = new RegExp(`^\\| ([^|]+) \\|(?: [^|]+ \\|){${FIGURES}}$`, "gm");
const confidences = /^\| confidence *\| *poses *\| *right % *\|\n\|.*\n(\|.*\n)*/m;

/** The cells of the rows of tables in a text. @param {string} text */
const rowsIn = (text) =>
  text
    .split("\n")
    .filter((line) => /^\|.*\d/.test(line))
    .map((line) =>
      line
        .split("|")
        .slice(1, -1)
        .map((cell) => cell.trim()),
    );

/** A function that brings the figures in a text up to date. */
function update() {
  const record = existsSync(recordFile) ? readFileSync(recordFile, "utf8") : "";
  const known = new Map(rowsIn(record).map(([set, name, ...cells]) => [`${set} | ${name}`, cells.slice(0, FIGURES)]));
  const [trusted = ""] = confidences.exec(record) ?? [];
  return (/** @type {string} */ text) =>
    text
      .replace(row, (all, title) => {
        const cells = known.get(titles[title] ?? "");
        return cells === undefined ? all : `| ${title} | ${cells.join(" | ")} |`;
      })
      .replace(confidences, () => trusted);
}

/** The picture of the figures in the page of the record. */
function picture() {
  const record = readFileSync(recordFile, "utf8");
  const [trusted = ""] = confidences.exec(record) ?? [];
  return recordPicture(rowsIn(record.replace(confidences, "")), rowsIn(trusted));
}

export async function writeFigures() {
  rewrite(files(), update());
  if (existsSync(recordFile)) writeFileSync(pictureFile, picture());
}

/** @throws if a document or the picture disagrees with the record */
export async function checkFigures() {
  holdUpToDate(files(), update(), "docs/record.md");
  holdUpToDate([pictureFile], picture, "docs/record.md");
}
