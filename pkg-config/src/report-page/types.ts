/** What the page of a report reads: rows for the table, and details that are loaded on demand. */
import type { CasePictures } from "../pictures/case-pictures.js";
import type { Row } from "./columns.js";

/** A case in the table. */
export interface ReportRow extends Row {
  name: string;
  /** The folder of its pictures; missing where there are none. */
  folder?: string;
}

/** What is loaded when a case is shown. */
export interface ReportDetails extends Omit<CasePictures, "files"> {
  alternatives: { file: string; turnDeg: number; score: number }[];
  matrix: number[];
}

/** The global object that the scripts of a report call. */
export interface ReportHost {
  rows: ReportRow[];
  details: Record<string, ReportDetails>;
}
