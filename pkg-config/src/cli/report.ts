/** A report: a page with a row for each pose, and a folder of pictures for each. It is complete after each of them. */
import { createHash } from "node:crypto";
import { existsSync } from "node:fs";
import { basename, join, resolve } from "node:path";
import { casePictures } from "../pictures/case-pictures.js";
import { type Entry, isFailure, rowOf } from "./entry.js";
import { bytesOf, namesIn, UsageError } from "./files.js";
import { OutputFile } from "./output-file.js";
import { type Column, type ColumnName, cellOf, columns, type Message, numberIn, type Row } from "./row.js";
import type { RunFiles } from "./run-files.js";

type PictureName = keyof typeof casePictures;
const pictureNames = Object.keys(casePictures) as PictureName[];

/** The columns of numbers after the name and the warnings. Errors are empty where no true pose is known. */
const numbers = [
  ...(["alternatives", "scale", "iou", "boundaryF", "depthMaeM"] as const),
  ...(["scaleError", "rotationErrorDeg", "translationErrorRelative", "timeMs"] as const),
];

const PAGE = "index.html";
/** By this, a page is known to be a report. */
const MARKER = '<meta name="generator" content="sim3align report">';

/** The files of a report. */
export class ReportFolder {
  readonly #page: OutputFile;

  private constructor(
    private readonly folder: string,
    private readonly files: RunFiles,
  ) {
    const path = join(folder, PAGE);
    files.write({ flag: "--report", path }, pageHead(basename(resolve(folder))));
    // Browsers close the table by themselves: the page has the rows so far.
    this.#page = new OutputFile(path, true);
  }

  /**
   * Writes a page without rows, into a folder that is there. A report in it gets new rows.
   * @throws {@link UsageError} if the folder has other content
   */
  static open(folder: string, files: RunFiles): ReportFolder {
    const names = namesIn(folder);
    const isReport = names.includes(PAGE) && bytesOf(join(folder, PAGE), 0, 4096).toString().includes(MARKER);
    if (names.length > 0 && !isReport)
      throw new UsageError(`--report ${folder}: the folder has other content. Pass a new folder.`);
    return new ReportFolder(folder, files);
  }

  #path(name: string, picture: PictureName): string {
    return join(this.folder, "cases", fileName(name), `${picture}.png`);
  }

  /** Whether the pictures of a pose are there. */
  has(name: string): boolean {
    return pictureNames.every((picture) => existsSync(this.#path(name, picture)));
  }

  /** Adds a row to the table; its pictures are shown if they are there. */
  add(name: string, entry: Entry): void {
    // Those of a case that fails now are of an earlier run.
    const hasPictures = !isFailure(entry) && this.has(name);
    this.#page.lines([rowHtml(name, rowOf(entry), hasPictures)]);
  }

  /** Writes the pictures of a pose. */
  write(name: string, pictures: Record<PictureName, Uint8Array>): void {
    for (const picture of pictureNames)
      this.files.write({ flag: "--report", path: this.#path(name, picture) }, pictures[picture]);
  }

  end(): void {
    this.#page.end();
  }
}

/** The name of the files of a case: its own, if all file systems can have it, otherwise with a checksum. */
export function fileName(name: string): string {
  if (/^[a-z0-9][a-z0-9._-]{0,80}$/.test(name)) return name;
  const check = createHash("sha256").update(name).digest("hex").slice(0, 8);
  const plain = name.replace(/[^A-Za-z0-9._-]+/g, "-").replace(/^[.-]+/, "");
  return `${plain.slice(-80)}-${check}`;
}

const escaped = (text: string) => text.replace(/[&<>"]/g, (character) => `&#${character.charCodeAt(0)};`);

/** A row. `data-key` is the sort key of a cell that is not its text; failures are the least certain of all. */
function rowHtml(name: string, row: Row, hasPictures: boolean): string {
  const { error, warnings } = row;
  const folder = `cases/${encodeURIComponent(fileName(name))}`;
  const images = pictureNames.map((picture) => {
    const text = `alt="${casePictures[picture]}" title="${casePictures[picture]}"`;
    return hasPictures ? `<td><img src="${folder}/${picture}.png" ${text} width=120 height=90 loading=lazy>` : "<td>";
  });
  const messages = (error === undefined ? warnings : [error, ...warnings]).map(messageHtml);
  const cell = (column: ColumnName) => `<td data-key="${numberIn(row, column) ?? ""}">${cellOf(row, column)}`;
  const confidence = error === undefined ? cell("confidence") : '<td class="failed" data-key="-1">failed';
  return `<tr><th scope=row>${escaped(name)}${confidence}${images.join("")}<td>${messages.join("")}${numbers.map(cell).join("")}`;
}

const messageHtml = ({ code, message }: Message) =>
  `<details><summary>${escaped(code)}</summary>${escaped(message)}</details>`;

const style = `
:root { color-scheme: light; font: 14px/1.4 system-ui, sans-serif; color: #1d2530; background: #f6f7f9; }
body { margin: 0; } h1 { font-size: 17px; margin: 12px 16px; }
table { border-collapse: collapse; background: #fff; font-variant-numeric: tabular-nums; }
thead th { position: sticky; top: 0; background: #eef1f4; font-size: 12px; vertical-align: bottom; }
th, td { padding: 4px 6px; border-bottom: 1px solid #dfe3e8; text-align: left; vertical-align: top; font-weight: 400; }
tbody th { font-weight: 600; min-width: 7em; max-width: 16em; overflow-wrap: anywhere; } img { display: block; border-radius: 3px; }
thead button { all: unset; cursor: pointer; font-weight: 600; } :focus-visible { outline: 2px solid #1660c4; }
[aria-sort="ascending"] button::after { content: " ▲" / ""; } [aria-sort="descending"] button::after { content: " ▼" / ""; }
details { max-width: 22em; font-size: 12px; color: #6a4a00; } .failed { color: #a3211b; }
`;

/** Sorts the rows by a column: at first by confidence. Missing values come last in either order. */
const script = `
addEventListener("DOMContentLoaded", () => {
  const [heads, body] = [[...document.querySelectorAll("thead th")], document.querySelector("tbody")];
  const keyOf = (row, k) => row.cells[k].dataset.key ?? row.cells[k].innerText;
  const sort = (k) => {
    const isDescending = heads[k].ariaSort === "ascending";
    for (const head of heads) head.ariaSort = null;
    heads[k].ariaSort = isDescending ? "descending" : "ascending";
    const compare = (a, b) =>
      (a === "") - (b === "") || (isDescending ? -1 : 1) * a.localeCompare(b, "en", { numeric: true });
    const numeric = (a, b) => (a === "") - (b === "") || (isDescending ? b - a : a - b);
    const isNumeric = body.rows[0]?.cells[k].dataset.key !== undefined;
    const rows = [...body.rows].map((row) => [keyOf(row, k), row]);
    body.append(...rows.sort(([a], [b]) => (isNumeric ? numeric : compare)(a, b)).map(([, row]) => row));
  };
  heads.forEach((head, k) => head.querySelector("button")?.addEventListener("click", () => sort(k)));
  sort(1);
});
`;

/** The page up to its first row. */
function pageHead(title: string): string {
  const sortable = (heading: string, tooltip = "") =>
    `<th scope=col><button type=button title="${tooltip}">${heading}</button>`;
  const column = (name: ColumnName) => {
    const { heading = "", title: tooltip }: Column = columns[name];
    return sortable(heading, tooltip);
  };
  const heads = [
    ...[sortable("Case"), column("confidence")],
    ...["Photo or depth", "Overlay", "From the side"].map((heading) => `<th scope=col>${heading}`),
    ...[sortable("Warnings"), ...numbers.map(column)],
  ];
  return `<!doctype html>
<html lang="en">
<meta charset="utf-8">
${MARKER}
<meta name="viewport" content="width=device-width">
<title>${escaped(title)}</title>
<style>${style}</style>
<script>${script}</script>
<main>
<h1>${escaped(title)}</h1>
<table>
<thead><tr>${heads.join("")}</thead>
<tbody>
`;
}
