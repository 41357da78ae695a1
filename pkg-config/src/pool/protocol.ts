/** What an aligner and its workers tell each other. One request at a time; each ends in a result or an error. */
import type { ErrorParts } from "../error.js";
import type { Stage } from "../generated/types.js";
import type { Job } from "../jobs.js";

/** To the worker. */
export type Request =
  /** The first: the compiled core. */
  | { type: "start"; core: WebAssembly.Module }
  /** What the worker asked for: the compiled file readers, or why there are none. */
  | { type: "formats"; module: WebAssembly.Module }
  | { type: "formats"; error: ErrorParts }
  | { type: "job"; job: Job; wantsProgress: boolean; returnData: boolean }
  | ShareRequest;

/** An alignment that several work on, step by step. */
export type ShareRequest =
  /** Prepares the search. */
  | { type: "share"; job: Job & { method: "align" } }
  /** Takes what came of the last round's tasks, and does a part of the next one's; without parts, forgets the share. */
  | { type: "step"; found: Float64Array | undefined; part: number; parts: number }
  | { type: "finish"; wantsProgress: boolean };

/** From the worker. */
export type Reply =
  | { type: "progress"; stage: Stage; fraction: number; best?: Float64Array | undefined }
  /** The worker needs the file readers. */
  | { type: "needs-formats" }
  | { type: "result"; result: unknown; data?: unknown }
  | { type: "error"; error: ErrorParts; data?: unknown };

/** How much of a shared alignment is done when its search is. */
export const SEARCHED = 0.75;
