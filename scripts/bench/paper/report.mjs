/** Tables and figures of a finished run, as files. */
import { copyFileSync, existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";
import { runLab } from "../../lib/lab.mjs";
import { at } from "../../lib/paths.mjs";
import { readRecords } from "../records.mjs";
import { recordsFile } from "../results.mjs";
import { figurePage } from "./figures.mjs";
import { makeTables, secondsOf, tableMarkdown } from "./tables.mjs";

/** @typedef {import("../records.mjs").BenchRecord} BenchRecord */
/** @typedef {import("./rows.mjs").TableSpec} TableSpec */
/** @typedef {{ id: string, title: string, markdown: string, data: unknown }} GeneralTable */
/** @typedef {Awaited<ReturnType<typeof import("../results.mjs").environment>>} Environment */
/**
 * @typedef {object} Finished
 * @property {readonly TableSpec[]} specs
 * @property {string} out
 * @property {Environment & { software: Record<string, string>, setSeed: number, scenes: number }} run
 * @property {Record<string, string>} folders case folders by prior
 * @property {readonly GeneralTable[]} general
 * @property {boolean} snapshot
 */

/** Rows whose errors and overlaps are drawn, where they were run. */
const drawn = [
  "precise",
  "precise, fast",
  "paper",
  "RANSAC, rigid",
  "GICP",
  "FGR",
  "open3d-ransac-scale",
  "kiss-matcher",
];
/** Rows whose best, median and worst poses are shown. */
const shown = ["precise", "paper"];

const notes = `Every metric is the mean over the cases, with the median in brackets. A case without an answer, or whose pose shows nothing where
the object is, counts 0 in shares (boundary F, IoU, fitness, normals) and is left out of distances. *strict*: scale within 5 %,
rotation within 10° up to symmetry, translation within 5 % of the diameter; *loose*: twice that. Scale, rotation and
translation are median errors, no answer being as wrong as can be. *collapsed*: s < 0.3 s_init; *clamped*: s stands at a bound
of the guard. *s* is the median time of an answer while all threads are at work, for orientation only. *(the true pose)* is
what the truth itself scores against a faulty depth map, mask and mesh.`;

/**
 * Writes tables.json (which has no times: the same seed gives the same file), times.json, run.json, tables.md and
 * figures.svg.
 * @param {Finished} finished
 * @returns {Promise<string>} the Markdown
 */
export async function report({ specs, out, run, folders, general, snapshot }) {
  const files = Object.keys(folders).map((prior) => [prior, readRecords(recordsFile(out, prior))]);
  /** @type {Map<string, Map<string, BenchRecord[]>>} */
  const records = new Map(/** @type {[string, Map<string, BenchRecord[]>][]} */ (files));
  const recordsOf = (/** @type {string} */ prior, /** @type {string} */ row) => records.get(prior)?.get(row) ?? [];
  const tables = makeTables(specs, recordsOf, readPaperFigures());
  const seconds = secondsOf(tables, recordsOf);
  const sections = tables.map((table) => `## ${table.title}\n\n${tableMarkdown(table, seconds[table.id] ?? {})}`);
  sections.push(...general.map(({ title, markdown }) => `## ${title}\n\n${markdown}`));
  const markdown = `# Benchmark\n\n${described(run)}\n\n${notes}\n\n${sections.join("\n\n")}\n`;

  const write = (/** @type {string} */ name, /** @type {unknown} */ content) =>
    writeFileSync(join(out, name), typeof content === "string" ? content : `${JSON.stringify(content, null, 1)}\n`);
  write("tables.json", { tables, general: Object.fromEntries(general.map(({ id, data }) => [id, data])) });
  write("times.json", seconds);
  write("run.json", run);
  const [prior = ""] = Object.keys(folders);
  const series = drawn.map((method) => ({ method, records: recordsOf(prior, method) }));
  const pictures = await picturesOf(shown, (row) => recordsOf(prior, row), folders[prior] ?? "", out);
  write(
    "figures.svg",
    await figurePage(
      series.filter((one) => one.records.length > 0),
      pictures,
    ),
  );
  write("tables.md", `${markdown}\n![Errors by difficulty, histograms of IoU, and poses](figures.svg)\n`);
  if (snapshot) {
    mkdirSync(at("docs", "benchmark"), { recursive: true });
    for (const name of ["times.json", "run.json", "figures.svg", "tables.md"]) {
      copyFileSync(join(out, name), at("docs", "benchmark", name === "tables.md" ? "README.md" : name));
    }
  }
  return markdown;
}

/** @param {Finished["run"]} run */
function described({ commit, date, machine, system, node, rustc, software, setSeed, scenes }) {
  const libraries = Object.entries(software).map(([name, version]) => `${name} ${version}`);
  const versions = [rustc, `Node ${node}`, ...libraries].join(", ");
  return `Commit ${commit}, ${date.slice(0, 10)}, ${machine}, ${system}; ${versions}. Set seed ${setSeed}, ${scenes} scenes.`;
}

/** The paper's own figures, as far as they are known. @returns {import("./tables.mjs").PaperFigures} */
function readPaperFigures() {
  const file = at("benches", "paper.json");
  return existsSync(file) ? JSON.parse(readFileSync(file, "utf8")).tables : {};
}

/**
 * Pictures of the best, the median and the worst pose of rows, by IoU.
 * @param {readonly string[]} rows
 * @param {(row: string) => readonly BenchRecord[]} recordsOf
 * @param {string} cases
 * @param {string} out
 */
async function picturesOf(rows, recordsOf, cases, out) {
  const pictures = [];
  for (const row of rows) {
    const overlap = (/** @type {BenchRecord} */ { alignment }) => alignment?.metrics.iou ?? 0;
    const posed = recordsOf(row).filter(({ alignment }) => alignment !== null);
    const sorted = posed.sort((a, b) => overlap(b) - overlap(a));
    const chosen = { best: sorted[0], median: sorted[sorted.length >> 1], worst: sorted.at(-1) };
    for (const [rank, record] of Object.entries(chosen)) {
      if (record?.alignment) pictures.push(await pictureOf(`${row}, ${rank}`, record, cases, out));
    }
  }
  return pictures;
}

/**
 * @param {string} title
 * @param {BenchRecord} record
 * @param {string} cases
 * @param {string} out
 */
async function pictureOf(title, record, cases, out) {
  const file = join(out, `${title.replaceAll(/\W+/g, "-")}.png`);
  const folder = basename(cases) === record.name ? cases : join(cases, record.name);
  const matrix = record.alignment?.matrix.join(",") ?? "";
  const args = ["bench", "--cases", folder, "--picture", file, `--matrix=${matrix}`];
  await runLab(args);
  const png = readFileSync(file);
  const name = `${title}: ${record.name}, IoU ${(record.alignment?.metrics.iou ?? 0).toFixed(3)}`;
  // Width and height stand in a PNG's first chunk.
  return { title: name, png, width: png.readUInt32BE(16), height: png.readUInt32BE(20) };
}
