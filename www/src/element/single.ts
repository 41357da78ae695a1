/** `sim3align/element/single`: `<sim3-align>` and its workers in one script, which in a worker is that of the worker. */
export { Sim3AlignElement } from "./index.js";

if ("WorkerGlobalScope" in globalThis) {
  if (self.name === "reader") void import("../input/reader-worker.js");
  else void import("sim3align/worker");
}
