/** What the page of a report reads: rows for the table, and details that are loaded on demand. */
import type { SpaceJson } from "../pictures/space.js";

/** A case in the table. */
export interface ReportRow {
  name: string;
  /** The folder of its pictures; missing where there are none. */
  folder?: string;
  /** The code and the text of its failure. */
  error?: { code: string; message: string };
  confidence: number | null;
  /** Whether lengths are metric; otherwise, their unit is unknown. */
  isMetric: boolean;
  scale: number | null;
  alternatives: number;
  iou: number | null;
  boundaryF: number | null;
  chamferMm: number | null;
  depthMaeMm: number | null;
  /** Relative to the true pose, where it is known. */
  errors?: { scale: number; rotationDeg: number; translation: number };
  warnings: { code: string; message: string }[];
  timeMs: number | null;
}

/** What is loaded when a case is shown. */
export interface ReportDetails {
  limitMm: number;
  isPhoto: boolean;
  alternatives: { file: string; turnDeg: number; score: number }[];
  matrix: number[];
  space: SpaceJson;
}

/** The global object that the scripts of a report call. */
export interface ReportHost {
  rows: ReportRow[];
  details: Record<string, ReportDetails>;
}
