/** Tables, and lengths with or without a unit. */
import { stripVTControlCharacters } from "node:util";
import { type Entry, isFailure, rowOf } from "./entry.js";
import { type ColumnName, cellOf, columns, fixed } from "./row.js";
import type { Style } from "./terminal.js";

/** A column of text. Longer cells shift the rest of their row. */
export interface TextColumn {
  heading: string;
  isNumber?: boolean;
  /** Minimum width in characters; the heading may be longer. */
  width?: number;
}

/** A column of numbers. */
export const numeric = (heading: string, width = 6): TextColumn => ({ heading, isNumber: true, width });

/** Width of a text on a terminal, without escape sequences. */
const textWidth = (text: string) => [...stripVTControlCharacters(text)].length;

function pad(text: string, to: number, isNumber: boolean): string {
  const space = " ".repeat(Math.max(0, to - textWidth(text)));
  return isNumber ? space + text : text + space;
}

/** A row of a table. In a row with fewer cells than columns, all cells are text. */
export const tableLine = (row: readonly TextColumn[], cells: readonly string[]): string =>
  row
    .slice(0, cells.length)
    .map(({ heading, isNumber = false, width = 0 }, i) =>
      pad(cells[i] ?? "", Math.max(width, textWidth(heading)), isNumber && cells.length === row.length),
    )
    .join("  ")
    .trimEnd();

/** The headings of a table. */
export const headings = (row: readonly TextColumn[]) =>
  tableLine(
    row,
    row.map(({ heading }) => heading),
  );

/**
 * A table of cases with these columns, which do not depend on the results.
 * @returns the lines of a case; the first one is preceded by the headings
 */
export function caseTable(names: readonly string[], shown: readonly ColumnName[]) {
  const width = names.reduce((widest, name) => Math.max(widest, textWidth(name)), 0);
  const numbers = shown.map((name) => numeric(columns[name].short, name === "scale" ? 9 : 6));
  const all = [{ heading: "case", width }, ...numbers];
  let isEmpty = true;
  return (name: string, entry: Entry, style: Style): string[] => {
    const row = rowOf(entry);
    const cells = isFailure(entry) ? [style.red(entry.error.code)] : shown.map((column) => cellOf(row, column));
    const first = isEmpty ? [style.bold(headings(all))] : [];
    isEmpty = false;
    return [...first, tableLine(all, [name, ...cells])];
  };
}

/** A name and its value. */
export type Pair = readonly [name: string, value: string];

/** Names and values in two columns, indented. */
export function pairs(entries: readonly Pair[]): string[] {
  const longest = Math.max(...entries.map(([name]) => textWidth(name)));
  return entries.map(([name, value]) => `  ${pad(name, longest, false)}  ${value}`);
}

/** The format of lengths. */
export class Lengths {
  constructor(readonly isMetric: boolean) {}

  /** The unit of numbers without a prefix. */
  get unit(): string {
    return this.isMetric ? "m" : "units";
  }

  /** A small length of this many metres, in millimetres; without a unit, it has three more decimals. */
  small(length: number | null | undefined, digits: number): string {
    if (length === null || length === undefined) return fixed(length, digits);
    return this.isMetric ? `${fixed(1000 * length, digits)} mm` : `${fixed(length, digits + 3)} ${this.unit}`;
  }
}
