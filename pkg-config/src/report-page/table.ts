/** The table: sorted, filtered, and with elements for the rows in sight only. */
import { naturally } from "../values/order.js";
import { byId, element } from "./dom.js";
import { type Column, type ColumnName, cellOf, columns, numberIn, type ReportRow } from "./row.js";

/** Height of a row, pixels; the style sheet has the same. */
const ROW = 48;
/** Rows beyond those in sight, above and below. */
const SPARE = 6;

/** A column of the page. Missing sort keys come last in either order; a failure has no number. */
interface PageColumn extends Pick<Column, "heading" | "title"> {
  id: string;
  text(row: ReportRow): string;
  key(row: ReportRow): number | string | null;
}

const number = (id: ColumnName): PageColumn => ({
  ...{ ...(columns[id] as Column), id },
  ...{ text: (row) => cellOf(row, id), key: (row) => numberIn(row, id) },
});
const codesOf = ({ error, warnings }: ReportRow) => error?.code ?? warnings.map(({ code }) => code).join(", ");
const name: PageColumn = { id: "name", heading: "Case", text: (row) => row.name, key: (row) => row.name };
const warnings: PageColumn = { id: "warnings", heading: "Warnings", text: codesOf, key: (row) => codesOf(row) || null };

/** The columns of a report. Errors have columns only if a row has a true pose. */
function columnsOf(rows: readonly ReportRow[]): PageColumn[] {
  const metrics = (["alternatives", "scale", "iou", "boundaryF", "depthMaeM"] as const).map(number);
  const errors = (["scaleError", "rotationErrorDeg", "translationErrorRelative"] as const).map(number);
  const hasTruth = rows.some((row) => typeof row.scaleError === "number");
  return [number("confidence"), name, ...metrics, ...(hasTruth ? errors : []), warnings, number("timeMs")];
}

/** A filter of rows. */
export interface Filter {
  text: string;
  /** Only cases of a confidence up to this; failures count as 0. */
  upTo: number;
  /** Only failures, cases with warnings, or cases with alternatives. */
  only: string;
}

/** The table, whose rows can be selected. */
export class Table {
  readonly #columns: readonly PageColumn[];
  readonly #scroller = byId("scroller");
  readonly #body = byId("rows");
  #rows: ReportRow[] = [];
  #selected: ReportRow | undefined;
  #sort: { column: PageColumn; isDescending: boolean };
  #filter: Filter = { text: "", upTo: 1, only: "all" };

  constructor(
    private readonly all: readonly ReportRow[],
    private readonly onSelect: (row: ReportRow) => void,
  ) {
    this.#columns = columnsOf(all);
    this.#sort = { column: this.#columns[0] as PageColumn, isDescending: false };
    this.#drawHead();
    this.#scroller.addEventListener("scroll", () => this.#draw(), { passive: true });
    new ResizeObserver(() => this.#draw()).observe(this.#scroller);
    this.#body.addEventListener("click", (event) => {
      const index = (event.target as Element).closest("tr")?.dataset.index;
      if (index === undefined) return;
      this.select(this.#rows[Number(index)]);
      // The button that had the focus is drawn anew.
      this.#scroller.focus({ preventScroll: true });
    });
    // Of the whole page: nothing has the focus after loading.
    document.addEventListener("keydown", (event) => {
      const step = { ArrowDown: 1, ArrowUp: -1, PageDown: 10, PageUp: -10 }[event.key];
      if (step === undefined || this.#rows.length === 0 || isForOthers(event)) return;
      event.preventDefault();
      const at = this.#selected === undefined ? -1 : this.#rows.indexOf(this.#selected);
      this.select(this.#rows[Math.min(Math.max(at + step, 0), this.#rows.length - 1)]);
      this.#show();
    });
    this.#update();
  }

  /** Shows the rows that pass a filter. */
  filter(filter: Filter): void {
    this.#filter = filter;
    this.#scroller.scrollTop = 0;
    this.#update();
  }

  /** Selects a row; without one, the first. */
  select(row: ReportRow | undefined = this.#rows[0]): void {
    if (row === undefined) return;
    this.#selected = row;
    this.#draw();
    this.onSelect(row);
  }

  #update(): void {
    const { text, upTo, only } = this.#filter;
    const wanted = text.toLowerCase();
    const passes = (row: ReportRow) =>
      (wanted === "" ||
        `${row.name} ${row.error?.code ?? ""} ${row.warnings.map((w) => w.code).join(" ")}`
          .toLowerCase()
          .includes(wanted)) &&
      (row.confidence ?? 0) <= upTo &&
      (only !== "failures" || row.error !== undefined) &&
      (only !== "warnings" || row.warnings.length > 0) &&
      (only !== "alternatives" || (row.alternatives ?? 0) > 0);
    const { column, isDescending } = this.#sort;
    this.#rows = this.all.filter(passes).sort((a, b) => compared(column.key(a), column.key(b), isDescending));
    // Failures are the least certain of all.
    if (column.id === "confidence" && !isDescending) {
      this.#rows.sort((a, b) => Number(b.error !== undefined) - Number(a.error !== undefined));
    }
    byId("count").textContent = `${this.#rows.length} of ${this.all.length} cases`;
    byId("table").setAttribute("aria-rowcount", String(this.#rows.length + 1));
    this.#draw();
  }

  #drawHead(): void {
    const cells = this.#columns.map((column) => {
      const { id, heading = "", title } = column;
      const button = element("button", { type: "button", title }, heading);
      button.addEventListener("click", () => {
        this.#sort = { column, isDescending: this.#sort.column === column && !this.#sort.isDescending };
        this.#drawHead();
        this.#update();
        byId("head").querySelector<HTMLElement>(`[data-id="${id}"] button`)?.focus();
      });
      const order = this.#sort.column !== column ? "none" : this.#sort.isDescending ? "descending" : "ascending";
      return element("th", { scope: "col", "data-id": id, "aria-sort": order }, button);
    });
    byId("head").replaceChildren(
      element("tr", { "aria-rowindex": 1 }, element("th", { scope: "col" }, "Picture"), ...cells),
    );
  }

  /** Scrolls to the selected row. */
  #show(): void {
    if (this.#selected === undefined) return;
    const top = this.#rows.indexOf(this.#selected) * ROW;
    const { scrollTop, clientHeight } = this.#scroller;
    const head = byId("head").clientHeight;
    if (top < scrollTop) this.#scroller.scrollTop = top;
    else if (top + ROW + head > scrollTop + clientHeight) this.#scroller.scrollTop = top + ROW + head - clientHeight;
  }

  /** Makes elements for the rows in sight. */
  #draw(): void {
    const first = Math.max(0, Math.floor(this.#scroller.scrollTop / ROW) - SPARE);
    const count = Math.ceil(this.#scroller.clientHeight / ROW) + 2 * SPARE;
    const end = Math.min(this.#rows.length, first + count);
    const width = this.#columns.length + 1;
    const spacer = (rows: number) => {
      const cell = element("td", { colspan: width, class: "spacer", style: `height:${rows * ROW}px` });
      return rows > 0 ? [element("tr", { "aria-hidden": "true" }, cell)] : [];
    };
    const rows = this.#rows.slice(first, end).map((row, i) => this.#row(row, first + i));
    this.#body.replaceChildren(...spacer(first), ...rows, ...spacer(this.#rows.length - end));
  }

  #row(row: ReportRow, index: number): HTMLTableRowElement {
    const cells = this.#columns.map((column) => {
      const { id } = column;
      const text = column.text(row);
      if (id === "name")
        return element("th", { scope: "row", title: text }, element("button", { type: "button", tabindex: -1 }, text));
      if (id !== "confidence") return element("td", { class: id === "warnings" ? "words" : "", title: text }, text);
      if (row.error !== undefined) return element("td", {}, element("span", { class: "failed" }, "failed"));
      const bar = element("span", { class: "bar", style: `--share:${row.confidence ?? 0}` });
      return element("td", {}, bar, text);
    });
    const picture = { src: `cases/${row.folder}/thumbnail.png`, alt: "", loading: "lazy", decoding: "async" };
    const shown = row.folder === undefined ? null : element("img", { ...picture, width: 56, height: 42 });
    const place = { "data-index": index, "aria-rowindex": index + 2 };
    const made = element("tr", place, element("td", {}, shown), ...cells);
    if (row === this.#selected) made.setAttribute("aria-selected", "true");
    return made;
  }
}

/** Whether a key is that of a control, of the details, or of the browser. */
function isForOthers({ target, defaultPrevented, ctrlKey, altKey, metaKey }: KeyboardEvent): boolean {
  const isElsewhere = target instanceof Element && target.closest("input, select, textarea, canvas, #detail") !== null;
  return defaultPrevented || ctrlKey || altKey || metaKey || isElsewhere;
}

function compared(a: number | string | null, b: number | string | null, isDescending: boolean): number {
  if (a === null || b === null) return Number(a === null) - Number(b === null);
  const order = typeof a === "string" || typeof b === "string" ? naturally(String(a), String(b)) : a - b;
  return isDescending ? -order : order;
}
