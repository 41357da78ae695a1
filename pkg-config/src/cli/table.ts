/** Aligned columns of text, and the numbers in them. */
import { stripVTControlCharacters } from "node:util";

/** A column. Longer cells shift the rest of their row. */
export interface Column {
  heading: string;
  isNumber?: boolean;
  /** Minimum width in characters; the heading may be longer. */
  width?: number;
}

/** Width of a text on a terminal, without escape sequences. */
export const textWidth = (text: string) => [...stripVTControlCharacters(text)].length;

function pad(text: string, to: number, isNumber: boolean): string {
  const space = " ".repeat(Math.max(0, to - textWidth(text)));
  return isNumber ? space + text : text + space;
}

/** A row of a table. In a row with fewer cells than columns, all cells are text. */
export function tableLine(columns: readonly Column[], cells: readonly string[]): string {
  return columns
    .slice(0, cells.length)
    .map(({ heading, isNumber = false, width = 0 }, i) =>
      pad(cells[i] ?? "", Math.max(width, textWidth(heading)), isNumber && cells.length === columns.length),
    )
    .join("  ")
    .trimEnd();
}

/** The headings of a table. */
export const headings = (columns: readonly Column[]) =>
  tableLine(
    columns,
    columns.map(({ heading }) => heading),
  );

/** A name and its value. */
export type Row = readonly [name: string, value: string];

/** Names and values in two columns, indented. */
export function pairs(entries: readonly Row[]): string[] {
  const longest = Math.max(...entries.map(([name]) => textWidth(name)));
  return entries.map(([name, value]) => `  ${pad(name, longest, false)}  ${value}`);
}

/** Formats a number with a fixed number of decimals; a missing one is a dash. */
export function fixed(value: number | null | undefined, digits: number): string {
  return value === null || value === undefined ? "–" : value.toFixed(digits);
}

/** Formats a number with the given significant digits, without an exponent if a few zeros suffice. */
export function significant(value: number | null | undefined, digits: number): string {
  if (value === null || value === undefined) return "–";
  if (value === 0 || !Number.isFinite(value)) return String(value);
  const magnitude = Math.floor(Math.log10(Math.abs(value)));
  return magnitude < -5 || magnitude > 8
    ? value.toExponential(digits - 1)
    : value.toFixed(Math.max(0, digits - 1 - magnitude));
}
