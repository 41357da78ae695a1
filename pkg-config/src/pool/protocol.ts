/**
 * The messages between a pool and its workers. A worker is started once, then asked for one job at a time; each job ends
 * in one `done`.
 */
import type { ErrorParts } from "../error.js";
import type { Stage } from "../generated/types.js";
import type { Job } from "../jobs.js";

/** To the worker. */
export type Request =
  /** The first message: the compiled core. */
  | { type: "start"; core: WebAssembly.Module }
  /** `returnData` asks for the job's data back, which have been moved to the worker. */
  | { type: "job"; job: Job; wantsProgress: boolean; returnData: boolean }
  /** Frees what the worker keeps of a prepared mesh. */
  | { type: "drop-mesh"; id: number }
  /** The answer to `needs-formats`: the compiled file readers, or why they could not be loaded. */
  | { type: "formats"; formats: WebAssembly.Module | ErrorParts };

/** From the worker. */
export type Reply =
  | { type: "progress"; stage: Stage; fraction: number; best?: Float64Array | undefined }
  | { type: "needs-formats" }
  | { type: "done"; result: unknown; data?: unknown; error?: undefined }
  | { type: "done"; error: ErrorParts; data?: unknown };
