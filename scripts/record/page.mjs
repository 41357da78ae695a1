/** The page of the record: what the history in the repository holds, as one static file. */
import { fixed, megabytes } from "../bench/table.mjs";
import { coverageChart, reliabilityChart } from "./charts.mjs";
import { cellsOf, head } from "./columns.mjs";
import { commandOf, sets } from "./sets.mjs";

/** Rows whose confidences the diagrams pool: poses of one call, found without being told anything. */
const pooled = /** @type {const} */ (["general", "sensors", "colors", "scenes", "views", "monocular"]);

/**
 * @param {readonly import("./history.mjs").Version[]} versions the oldest first
 * @returns {string} HTML
 */
export function recordPage(versions) {
  const last = versions.at(-1);
  if (last === undefined)
    return page("<p>No version has been recorded yet: <code>npm run record -- --save</code>.</p>");
  const { run, rows, doubts } = last;
  const parts = [
    `<p>Version ${text(run.version)}, commit <code>${text(run.commit.slice(0, 10))}</code>, ${text(run.date.slice(0, 10))}, on
${text(run.machine)}. All cases are generated from seeds that nothing was set with; the same commit gives the same rows to the
bit. <code>npm run record</code> makes everything here; <code>SIM3ALIGN_CASES=DIR npm run record</code> adds your own case
folders.</p>`,
    "<h2>Accuracy</h2>",
    `<p>Strict: scale within 5 %, rotation within 10° up to symmetry, place within 5 % of the diameter; loose: twice that. Of
monocular depth, the apparent size and the place in the image count instead. Errors are medians of the answered cases. IoU is
that of the mask, beside that of the true pose: with faulty depth, masks and meshes, no pose reaches 1.${peersText(run)}</p>`,
    ...sets.map((set) => setTable(set, rows)).filter(Boolean),
    "<h2>How far a confidence can be trusted</h2>",
    `<p>The share of strictly right poses by the confidence that came with them, with the number of poses in each tenth: on
the diagonal, a confidence is a probability. Below: what is left, and how much of it is right, if poses below a confidence
are left out.</p>`,
    `<div class="charts">${pooled
      .map((set) => ({ set, bins: binsOf(rows, set) }))
      .filter(({ bins }) => bins.length > 0)
      .map(
        ({ set, bins }) => `<figure>${reliabilityChart(bins)}${coverageChart(bins)}<figcaption>${text(setOf(set).title)}
<code>${text(commandOf(setOf(set)))}</code></figcaption></figure>`,
      )
      .join("")}</div>`,
    "<h2>Time and size, by version</h2>",
    versionTable(versions),
    memoryTable(run),
    "<h2>Cases that this version doubts most</h2>",
    table(
      ["set", "case", "confidence", "right", "why"],
      doubts.map(({ set, case: name, confidence, strict, doubt }) => [
        ...[set, name, fixed(confidence, 2), strict ? "yes" : "no", doubt],
      ]),
    ),
  ];
  return page(parts.join("\n"));
}

/** Titles and commands of the pooled sets. @param {string} name */
const setOf = (name) => /** @type {import("./sets.mjs").RecordSet} */ (sets.find((set) => set.name === name));

/**
 * @param {import("./sets.mjs").RecordSet} set
 * @param {readonly import("./summary.mjs").Summary[]} rows
 */
function setTable(set, rows) {
  const own = rows.filter((row) => row.set === set.name);
  if (own.length === 0) return "";
  const note = set.note === undefined ? "" : `<p>${text(set.note)}</p>`;
  return `<h3>${text(set.title)}</h3>${note}${table(head, own.map(cellsOf))}<p class="command"><code>${text(commandOf(set))}</code></p>`;
}

/**
 * The bins of all rows of a set, added; none where no row has a confidence.
 * @param {readonly import("./summary.mjs").Summary[]} rows
 * @param {string} set
 * @returns {(readonly [n: number, right: number])[]}
 */
function binsOf(rows, set) {
  const of = rows.filter((row) => row.set === set && row.bins.length > 0);
  const sum = (/** @type {number} */ bin, /** @type {0 | 1} */ which) =>
    of.reduce((all, { bins }) => all + (bins[bin]?.[which] ?? 0), 0);
  return (of[0]?.bins ?? []).map((_, bin) => [sum(bin, 0), sum(bin, 1)]);
}

/** @param {readonly import("./history.mjs").Version[]} versions */
function versionTable(versions) {
  const modules = [...new Set(versions.flatMap(({ run }) => Object.keys(run.sizes)))];
  const rows = versions.map(({ run, rows: all }) => {
    const general = all.find(({ set, row }) => set === "general" && row === "align");
    return [
      ...[run.version, run.date.slice(0, 10), run.machine, fixed(general?.ms), fixed(general?.work)],
      ...modules.map((name) => fixed((run.sizes[name] ?? Number.NaN) / 1000, 1)),
    ];
  });
  const titles = [
    "version",
    "date",
    "machine",
    "ms a case",
    "renders a case",
    ...modules.map((name) => `${name}, kB gz`),
  ];
  return `${table(titles, rows)}<p class="command"><code>npm test -- --only size</code></p><p>Times are CPU time of the native build; compare them on one machine only; the renders compare on any.</p>`;
}

/** @param {import("./history.mjs").Run} run */
function peersText({ peers = {} }) {
  const names = Object.entries(peers).map(([name, version]) => `${name} ${version}`);
  return names.length === 0 ? "" : ` Other libraries: ${text(names.join(", "))}.`;
}

/** @param {import("./history.mjs").Run} run */
function memoryTable({ memory = [] }) {
  if (memory.length === 0) return "";
  const rows = memory.map(({ name, bytes, limit }) => [name, megabytes(bytes), megabytes(limit)]);
  return `<h3>Memory in WebAssembly: one alignment of 227 000 triangles and a depth map of 1920 × 1080</h3>${table(["options", "MB", "limit"], rows)}<p class="command"><code>npm run bench:memory</code></p>`;
}

/** @param {readonly string[]} titles @param {readonly (readonly (string | number)[])[]} rows */
function table(titles, rows) {
  const line = (/** @type {readonly (string | number)[]} */ cells, /** @type {string} */ tag) =>
    `<tr>${cells.map((cell) => `<${tag}>${text(`${cell}`)}</${tag}>`).join("")}</tr>`;
  return `<div class="scroll" tabindex="0"><table><thead>${line(titles, "th")}</thead><tbody>${rows.map((row) => line(row, "td")).join("")}</tbody></table></div>`;
}

const text = (/** @type {string} */ value) => value.replace(/[&<>"]/g, (character) => `&#${character.charCodeAt(0)};`);

/** @param {string} content */
const page = (content) => `<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>The record of sim3align</title>
<style>
:root { color-scheme: light dark; font: 15px/1.5 system-ui, sans-serif; --line: light-dark(#ccd, #445); --mark: light-dark(#1663c7, #7cb2ff); }
body { max-width: 70rem; margin: 2rem auto; padding: 0 1rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .2rem .7rem; border-bottom: 1px solid var(--line); text-align: right; white-space: nowrap; }
:is(th, td):first-child, td:last-child:not(:only-child) { text-align: left; }
.scroll { overflow-x: auto; }
.command, figcaption { font-size: .85em; }
.charts { display: grid; grid-template-columns: repeat(auto-fill, minmax(18rem, 1fr)); gap: 1.5rem; }
figure { margin: 0; } svg { width: 100%; height: auto; } code { overflow-wrap: anywhere; }
</style>
<main>
<h1>The record of sim3align</h1>
${content}
</main>
`;
