/**
 * The messages between a pool and its workers. A worker runs one job, or helps another worker with one, at a time; each ends
 * with one result. The first job is empty: its result shows that the script runs.
 */
import type { Job } from "../calls/calls.js";
import type { Stage } from "../generated/types.js";
import type { ModuleName } from "../modules/exports.js";
import type { CompiledModule } from "../modules/module.js";
import type { ErrorParts } from "../values/error.js";
import { isRecord } from "../values/kinds.js";
import type { CoreMesh } from "../values/prepared-mesh.js";

/** Help for the worker at the other end of a port with its job. */
export interface HelpJob {
  method: "help";
  data: {
    port: MessagePort;
    /** The arrays of the prepared mesh of the job, unless the helper has them. */
    mesh: CoreMesh | undefined;
  };
}

/** A job for a worker. */
export interface Request {
  type: "job";
  job: Job | HelpJob | { method: "start" };
  wantsProgress?: boolean;
  /** Whether the data of the job, which were moved to the worker, are returned. */
  returnsData?: boolean;
  /** Compiled modules that the worker has not got before. */
  modules: ReadonlyMap<ModuleName, CompiledModule>;
  /** Prepared meshes that have been disposed. */
  droppedMeshes: readonly number[];
}

/** Messages to a worker. */
export type ToWorker =
  | Request
  /** To a worker that has asked for help: a helper, counted from 0, is at the other end of the port; or has left. */
  | { type: "helper"; helper: number; port?: MessagePort }
  /** To a helper: a job waits for it, or that of the other worker is done. */
  | { type: "stop" };

/** The outcome of a job. */
export interface Answer {
  type: "result";
  result?: unknown;
  error?: ErrorParts;
  /** The module that the job needs: it has not been run. */
  needs?: ModuleName;
  data?: unknown;
  /** The numbers of the instances of the modules: with an instance, its prepared meshes are lost. */
  instances: Instances;
}

/** The number of the instance of each module that is loaded. */
export type Instances = { readonly [N in ModuleName]?: number | undefined };

/** The progress of a job; without a stage, a sign that it is long, so that other workers may help. */
export type Report = { type: "progress"; stage?: undefined } | Progress;

interface Progress {
  type: "progress";
  stage: Stage;
  fraction: number;
  best?: Float64Array | undefined;
}

/** Messages from a worker. */
export type FromWorker = Report | Answer;

/** Whether a message is one of this package's `worker.js`: a worker of the caller may run another script. */
export const isFromWorker = (message: unknown): message is FromWorker =>
  isRecord(message) && (message.type === "progress" || (message.type === "result" && isRecord(message.instances)));
