/** The script of a report. */
import { Detail } from "./detail.js";
import { byId } from "./dom.js";
import type { ReportHost } from "./row.js";
import { Table } from "./table.js";

const host = (globalThis as unknown as { sim3align: ReportHost }).sim3align;
const detail = new Detail(host);
const table = new Table(host.rows, (row) => detail.show(row));
const [text, upTo, only] = [
  byId<HTMLInputElement>("text"),
  byId<HTMLInputElement>("up-to"),
  byId<HTMLSelectElement>("only"),
];

function filter(): void {
  byId("up-to-value").textContent = Number(upTo.value).toFixed(2);
  table.filter({ text: text.value.trim(), upTo: Number(upTo.value), only: only.value });
}

for (const control of [text, upTo, only]) control.addEventListener("input", filter);
const failures = host.rows.filter((row) => row.error !== undefined).length;
const confident = host.rows.filter((row) => (row.confidence ?? 0) >= 0.9).length;
byId("summary").textContent =
  `${host.rows.length} cases, ${failures} failed, ${confident} with a confidence of 0.9 or more`;
table.select();
