/** A report: a page, its rows, and a folder of pictures for each case. It is complete after each of them. */
import { createHash } from "node:crypto";
import { existsSync } from "node:fs";
import { readFile } from "node:fs/promises";
import { basename, join, resolve } from "node:path";
import type { CasePictures } from "../pictures/case-pictures.js";
import { columns, type ReportDetails, type ReportRow } from "../report-page/row.js";
import { alternativesOf, type Entry, isFailure, rowOf } from "./entry.js";
import { namesIn, UsageError } from "./files.js";
import { OutputFile } from "./output-file.js";
import type { RunFiles } from "./run-files.js";

/** The fields of a row on the page. */
const pageFields: readonly string[] = [...Object.keys(columns), "error", "warnings", "isMetric"];

/** The files of a report. */
export class ReportFolder {
  readonly #rows: OutputFile;

  private constructor(
    private readonly folder: string,
    private readonly files: RunFiles,
  ) {
    this.#write("rows.js", '"use strict";\n');
    // The page has the rows so far.
    this.#rows = new OutputFile(join(folder, "rows.js"), true);
  }

  #write(name: string, content: string | Uint8Array): void {
    this.files.write({ flag: "--report", path: join(this.folder, name) }, content);
  }

  /**
   * Writes a page without rows, into a folder that is there. A report in it gets new rows.
   * @throws {@link UsageError} if the folder has other content
   */
  static async open(folder: string, files: RunFiles): Promise<ReportFolder> {
    const names = namesIn(folder);
    if (names.length > 0 && !names.includes("rows.js"))
      throw new UsageError(`--report ${folder}: the folder has other content. Pass a new folder.`);
    const html = await reportHtml(basename(resolve(folder)));
    const report = new ReportFolder(folder, files);
    report.#write("index.html", html);
    return report;
  }

  /** Whether the pictures of a case are there. */
  has(name: string): boolean {
    return existsSync(join(this.folder, "cases", fileName(name), "details.js"));
  }

  /** Adds a row to the table; its pictures are shown if they are there. */
  add(name: string, entry: Entry): void {
    const fields = Object.entries(rowOf(entry)).filter(([field]) => pageFields.includes(field));
    // Those of a case that fails now are of an earlier run.
    const folder = this.has(name) && !isFailure(entry) ? { folder: fileName(name) } : {};
    const row = { name, ...folder, ...Object.fromEntries(fields) } as ReportRow;
    this.#rows.lines([`sim3align.rows.push(${JSON.stringify(row)});`]);
  }

  /** Writes the pictures of a case: `details.js` last: its presence means that all are there. */
  write(name: string, entry: Entry, { files, ...known }: CasePictures): void {
    const folder = join("cases", fileName(name));
    for (const [file, bytes] of Object.entries(files)) this.#write(join(folder, file), bytes);
    const alternatives = alternativesOf(entry).map(({ turnDeg, score }, k) => ({
      ...{ file: `alternative-${k + 1}.png`, turnDeg: Number(turnDeg), score: Number(score) },
    }));
    const details: ReportDetails = { ...known, alternatives, matrix: entry.matrix as number[] };
    const text = `sim3align.details[${JSON.stringify(fileName(name))}] = ${JSON.stringify(details)};\n`;
    this.#write(join(folder, "details.js"), text);
  }

  end(): void {
    this.#rows.end();
  }
}

/** The name of the files of a case: its own, if all file systems can have it, otherwise with a checksum. */
export function fileName(name: string): string {
  if (/^[a-z0-9][a-z0-9._-]{0,80}$/.test(name)) return name;
  const check = createHash("sha256").update(name).digest("hex").slice(0, 8);
  const plain = name.replace(/[^A-Za-z0-9._-]+/g, "-").replace(/^[.-]+/, "");
  return `${plain.slice(-80)}-${check}`;
}

const style = `
:root { color-scheme: light; font: 14px/1.45 system-ui, sans-serif; color: #1d2530; background: #f6f7f9; }
* { box-sizing: border-box; }
body { margin: 0; height: 100vh; display: grid; grid-template: auto 1fr / minmax(0, 1fr) 490px; }
header { grid-column: 1 / 3; display: flex; flex-wrap: wrap; gap: 6px 22px; align-items: center; padding: 10px 16px;
  background: #fff; border-bottom: 1px solid #dfe3e8; }
h1 { font-size: 17px; margin: 0; } h2 { font-size: 16px; margin: 0 0 8px; overflow-wrap: anywhere; }
h3 { font-size: 13px; margin: 16px 0 6px; color: #4a5563; }
p { margin: 0; } #summary, #count { color: #4a5563; }
form { display: flex; flex-wrap: wrap; gap: 6px 16px; align-items: center; margin-left: auto; }
input[type="search"], select { font: inherit; padding: 4px 8px; border: 1px solid #98a2b0; border-radius: 5px; background: #fff; color: inherit; }
label { white-space: nowrap; } input[type="range"] { vertical-align: middle; width: 110px; }
main { min-width: 0; min-height: 0; display: flex; }
#scroller { flex: 1; overflow: auto; }
table { border-collapse: separate; border-spacing: 0; width: 100%; font-variant-numeric: tabular-nums; background: #fff; }
thead th { position: sticky; top: 0; z-index: 1; background: #eef1f4; text-align: left; font-weight: 600; padding: 0 8px;
  height: 38px; border-bottom: 1px solid #dfe3e8; white-space: nowrap; }
thead button { all: unset; cursor: pointer; } thead button:focus-visible, tbody button:focus-visible { outline: 2px solid #1660c4; outline-offset: 2px; }
th[aria-sort="ascending"] button::after { content: " ▲" / ""; font-size: 10px; } th[aria-sort="descending"] button::after { content: " ▼" / ""; font-size: 10px; }
tbody tr { height: 48px; cursor: pointer; } tbody tr:hover { background: #f3f6fa; }
tbody tr[aria-selected="true"] { background: #e3eefb; }
tbody td, tbody th { padding: 0 8px; height: 48px; border-bottom: 1px solid #eceff2; text-align: left; font-weight: 400;
  white-space: nowrap; max-width: 260px; overflow: hidden; text-overflow: ellipsis; }
tbody th button { all: unset; cursor: pointer; font-weight: 600; } td.spacer { border: 0; padding: 0; height: auto; } td.words { color: #6a4a00; font-size: 12px; }
td img { display: block; border-radius: 3px; }
.bar { display: inline-block; width: 44px; height: 7px; margin-right: 7px; border-radius: 4px; background: linear-gradient(to right, #2f7fd6 calc(var(--share) * 100%), #dde3ea 0); }
.failed, .problem { color: #a3211b; }
aside { overflow: auto; background: #fff; border-left: 1px solid #dfe3e8; padding: 14px 16px 24px; }
.stack { position: relative; width: 440px; max-width: 100%; aspect-ratio: 4 / 3; background: #22222a; border-radius: 6px; overflow: hidden; }
.stack img { position: absolute; inset: 0; width: 100%; height: 100%; } [hidden] { display: none; }
.layers { display: flex; flex-wrap: wrap; gap: 4px 14px; margin: 8px 0; }
.legend { font-size: 12px; color: #4a5563; } .key { margin-left: 10px; white-space: nowrap; }
.key::before { content: ""; display: inline-block; width: 10px; height: 10px; margin-right: 4px; border: 1px solid #6b7683; border-radius: 2px; }
.key.mesh::before { background: #f08a24; } .key.mask::before { background: #fff; } .key.near::before { background: #1e64dc; } .key.far::before { background: #eb5f0a; }
canvas { width: 440px; max-width: 100%; border: 1px solid #dfe3e8; border-radius: 6px; touch-action: none; cursor: grab; }
canvas:focus-visible, pre:focus-visible { outline: 2px solid #1660c4; }
.alternatives { display: flex; flex-wrap: wrap; gap: 10px; } figure { margin: 0; } figcaption { font-size: 12px; color: #4a5563; }
figure img { display: block; border-radius: 4px; } ul.warnings { padding-left: 18px; margin: 10px 0; }
dl { display: grid; grid-template-columns: auto 1fr; gap: 2px 14px; margin: 0; } dt { color: #4a5563; } dd { margin: 0; font-variant-numeric: tabular-nums; }
pre { font-size: 12px; background: #f6f7f9; padding: 8px; border-radius: 5px; overflow: auto; }
@media (max-width: 900px) { body { height: auto; grid-template: auto 60vh auto / 1fr; } header { grid-column: 1; } aside { border-left: 0; } }
`;

/** The page: style and script are in it; rows and details are scripts beside it. */
async function reportHtml(title: string): Promise<string> {
  const script = await readFile(new URL("../report-page.js", import.meta.url), "utf8");
  return `<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>${escaped(title)}</title>
<style>${style}</style>
</head>
<body>
<header>
<h1>${escaped(title)}</h1>
<p id="summary"></p>
<form onsubmit="return false" role="search" aria-label="Filter">
<label>Find <input type="search" id="text" placeholder="name or warning"></label>
<label>Confidence up to <input type="range" id="up-to" min="0" max="1" step="0.01" value="1"> <output id="up-to-value" for="up-to">1.00</output></label>
<label>Show <select id="only"><option value="all">all</option><option value="failures">failures</option><option value="warnings">with warnings</option><option value="alternatives">with alternatives</option></select></label>
<p id="count" role="status"></p>
</form>
</header>
<main>
<div id="scroller" tabindex="0" role="region" aria-label="Cases">
<table id="table"><caption hidden>Cases</caption><thead id="head"></thead><tbody id="rows"></tbody></table>
</div>
</main>
<aside id="detail" aria-label="Details" tabindex="0"></aside>
<script>var sim3align = { rows: [], details: {} };</script>
<script src="rows.js"></script>
<script>${script.replaceAll("</script", "<\\/script")}</script>
</body>
</html>
`;
}

const escaped = (text: string) => text.replace(/[&<>"]/g, (character) => `&#${character.charCodeAt(0)};`);
