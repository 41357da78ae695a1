/** The figures of the record in documents: rows of tables with its columns, by their first cell, and the table of confidences. */
import { filesBelow } from "../lib/cache.mjs";
import { at } from "../lib/paths.mjs";
import { holdUpToDate, rewrite } from "../lib/rewrite.mjs";
import { history } from "./history.mjs";
import { cellsOf, head, reliability } from "./summary.mjs";

const files = () => [
  ...[at("README.md"), at("docs", "benchmark.md")],
  ...filesBelow([at("docs", "guides")]).filter((path) => path.endsWith(".md")),
];

/** The first cells of rows in documents, and the set and row of the record that they stand for. @type {Record<string, string>} */
const titles = {
  ...{ "one object": "general, align", "depth sensors": "sensors, align", "objects of a scene": "scenes, together" },
  ...{ "coloured, with a photo": "colors, align", "frames of a video": "videos, all masks" },
  ...{ "by shape": "colors, shape alone", "with colour": "colors, align" },
  ...{ "desks, alone": "scenes, alone", "desks, together": "scenes, together" },
  ...{ "affine-invariant depth": "models, affine", "affine-invariant disparity": "models, disparity" },
  "metric depth, no camera": "models, no-camera",
  "affine-invariant disparity, no camera": "models, disparity-no-camera",
  ...{ "with placements, alone": "placements, alone", "with placements, together": "placements, together" },
};

/** The columns of a row in documents: from the number of cases to the confident ones. */
const [first, last] = [head.indexOf("n"), head.indexOf("size held %")];
const row = new RegExp(`^\\| ([^|]+) \\|(?: [^|]+ \\|){${last - first}}$`, "gm");
const confidences = "| confidence | poses | right % |\n|---|---|---|\n";

/** A function that brings the figures in a text up to date. */
function update() {
  const rows = history().at(-1)?.rows ?? [];
  const known = new Map(rows.map((one) => [`${one.set}, ${one.row}`, cellsOf(one).slice(first, last)]));
  const trusted = reliability(rows).map((cells) => `| ${cells.join(" | ")} |\n`);
  return (/** @type {string} */ text) => {
    const now = text.replace(row, (all, title) => {
      const cells = known.get(titles[title] ?? "");
      return cells === undefined ? all : `| ${title} | ${cells.join(" | ")} |`;
    });
    const [before = "", after] = now.split(confidences);
    return after === undefined ? now : `${before}${confidences}${trusted.join("")}${after.replace(/^(\|.*\n)*/, "")}`;
  };
}

export const writeFigures = async () => rewrite(files(), update());

/** @throws if a document disagrees with the last whole record */
export const checkFigures = async () => holdUpToDate(files(), update(), "docs/record/history.jsonl");
