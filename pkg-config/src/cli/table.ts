/** Aligned columns of text. */
import { stripVTControlCharacters } from "node:util";

/** A column: its heading, and whether its cells are numbers. */
export interface Column {
  heading: string;
  isNumber?: boolean;
}

/** Width of a text on a terminal, without escape sequences. */
const width = (text: string) => [...stripVTControlCharacters(text)].length;

function pad(text: string, to: number, isNumber: boolean): string {
  const space = " ".repeat(Math.max(0, to - width(text)));
  return isNumber ? space + text : text + space;
}

/**
 * The lines of a table: the headings, then the rows. In a row with fewer cells, the last cell may exceed its column.
 */
export function table(columns: readonly Column[], rows: readonly (readonly string[])[]): string[] {
  const widths = columns.map(({ heading }, i) => {
    const cells = rows.filter((row) => row.length === columns.length || i < row.length - 1);
    return Math.max(width(heading), ...cells.map((row) => width(row[i] ?? "")));
  });
  const line = (cells: readonly string[]) =>
    cells
      .map((cell, i) => pad(cell, widths[i] ?? 0, columns[i]?.isNumber === true && cells.length === columns.length))
      .join("  ")
      .trimEnd();
  return [columns.map(({ heading }) => heading), ...rows].map(line);
}

/** Names and values in two columns, indented. */
export function pairs(entries: readonly (readonly [name: string, value: string])[]): string[] {
  const longest = Math.max(...entries.map(([name]) => width(name)));
  return entries.map(([name, value]) => `  ${pad(name, longest, false)}  ${value}`);
}
