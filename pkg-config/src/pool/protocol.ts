/**
 * The messages between a pool and its workers. A worker is started once, says that it is `ready`, and then runs one job, or
 * helps another worker with one, at a time; each ends with one `done`. `emptied` are the caches of meshes that were lost with the instance of their module: its heap had grown too
 * large, or it was exhausted.
 */
import { type ErrorParts, isCoded } from "../error.js";
import type { Stage } from "../generated/types.js";
import type { Job, MeshCache } from "../jobs.js";
import { isRecord } from "../kinds.js";
import type { CoreMesh } from "../prepared-mesh.js";
import type { ModuleName } from "../wasm-modules.js";

/** Messages to the worker. */
export type Request =
  /** The first message: the compiled core. */
  | { type: "start"; core: WebAssembly.Module }
  /** `returnData` requests the return of the data of the job, which were moved to the worker. */
  | { type: "job"; job: Job; wantsProgress: boolean; returnData: boolean }
  /** To help the worker at the other end of the port with its job, whose prepared mesh has these arrays. */
  | { type: "help"; port: MessagePort; mesh: CoreMesh | undefined }
  /** The answer to `needs-help`, once per helper: it is at the other end of the port. */
  | { type: "helper"; port: MessagePort }
  /** The helper that came at this place, from 0, has left. */
  | { type: "helper-left"; helper: number }
  /** To stop helping: a job waits for this worker, or that of the other one is done. */
  | { type: "stop-helping" }
  /** Frees the cached data of a prepared mesh. */
  | { type: "drop-mesh"; id: number }
  /** The answer to `needs-module`: the compiled module, or the reason for the failure to load it. */
  | { type: "module"; name: LazyName; module: WebAssembly.Module | ErrorParts };

/** The modules that a worker asks for when a job first needs them. */
export type LazyName = Exclude<ModuleName, "core">;

/** Messages from the worker. */
export type Reply =
  /** The answer to `start`: this script runs. */
  | { type: "ready" }
  | { type: "progress"; stage: Stage; fraction: number; best?: Float64Array | undefined }
  | { type: "needs-module"; name: LazyName }
  /** The running job is long: other workers may help. */
  | { type: "needs-help" }
  /** A message to the worker could not be read: its content is lost. */
  | { type: "unreadable" }
  | { type: "done"; result: unknown; data?: unknown; error?: undefined; emptied?: readonly MeshCache[] }
  | { type: "done"; error: ErrorParts; data?: unknown; emptied?: readonly MeshCache[] };

/**
 * Whether a message is one of this package's `worker.js`: a worker of the caller may run another script.
 * @param hasResult whether the result of the running job is an object; `undefined` if there is no job
 */
export function isReply(message: unknown, hasResult: boolean | undefined): message is Reply {
  if (!isRecord(message)) return false;
  const { type, result, error } = message;
  if (type !== "done") return ["ready", "progress", "needs-module", "needs-help", "unreadable"].includes(`${type}`);
  if (hasResult === undefined || error !== undefined) return hasResult !== undefined && isCoded(error);
  return "result" in message && (typeof result === "object" && result !== null) === hasResult;
}
