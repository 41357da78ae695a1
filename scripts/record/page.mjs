/** The page of the record: the history in the repository as one static file of tables. */
import { fixed } from "../bench/table.mjs";
import { commandOf, sets } from "./sets.mjs";
import { cellsOf, head, reliability } from "./summary.mjs";

/**
 * @param {readonly import("./history.mjs").Version[]} versions the oldest first
 * @returns {string} HTML
 */
export function recordPage(versions) {
  const last = versions.at(-1);
  if (last === undefined)
    return page("<p>No version has been recorded yet: <code>npm run record -- --save</code>.</p>");
  const { run, rows } = last;
  return page(`<p>Version ${text(run.version)}, commit <code>${text(run.commit.slice(0, 10))}</code>,
${text(run.date.slice(0, 10))}, on ${text(run.machine)}. All cases are generated from seeds with which nothing was set; the same
commit gives the same rows to the bit. <code>npm run record</code> makes everything here; <code>SIM3ALIGN_CASES=DIR npm run
record</code> adds your own case folders.</p>
<h2>Accuracy</h2>
<p>Strict: scale within 5 %, rotation within 10° up to symmetry, place within 5 % of the diameter; loose: twice that. Of
monocular depth, the apparent size and the place in the image count instead. Errors are medians of the answered cases. IoU is
that of the mask, beside that of the true pose: with faulty depth, masks and meshes, no pose reaches 1. Size held: of poses with a
confidence of 0.9 or more, how many sizes are within 1.645 times the standard deviation that the result states; 90 would be
exact.</p>
${sets.map((set) => setTable(set, rows)).join("\n")}
<h2>How far a confidence can be trusted</h2>
<p>The share of strictly right poses by confidence, which is a probability; without hints, videos, and objects whose photo was
withheld.</p>
${table(["confidence", "poses", "right %"], reliability(rows))}
<h2>Time and size, by version</h2>
${versionTable(versions)}`);
}

/**
 * @param {import("./sets.mjs").RecordSet} set
 * @param {readonly import("./summary.mjs").Summary[]} rows
 */
function setTable(set, rows) {
  const own = rows.filter((row) => row.set === set.name);
  if (own.length === 0) return "";
  const lines = own.map((row) => cellsOf(row).slice(1));
  return `<h3>${text(set.title)}</h3>${table(head.slice(1), lines)}<p><code>${text(commandOf(set))}</code></p>`;
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
  const sizes = modules.map((name) => `${name}, kB gz`);
  return `${table(["version", "date", "machine", "ms a case", "renders a case", ...sizes], rows)}<p>Times are CPU time of the
native build; compare them on one machine only; the renders compare on any.</p>`;
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
:root { color-scheme: light dark; font: 15px/1.5 system-ui, sans-serif; }
body { max-width: 76rem; margin: 2rem auto; padding: 0 1rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .2rem .7rem; border-bottom: 1px solid light-dark(#ccd, #445); text-align: right; white-space: nowrap; }
:is(th, td):first-child { text-align: left; }
.scroll { overflow-x: auto; }
code { overflow-wrap: anywhere; }
</style>
<main>
<h1>The record of sim3align</h1>
${content}
</main>
`;
