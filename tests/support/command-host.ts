/** A thread that runs the command line once for each message: Node and the WebAssembly modules start only once. */
import { fileURLToPath } from "node:url";
import { type MessagePort, workerData } from "node:worker_threads";

const { commandLine, done, port } = workerData as { commandLine: string; done: Int32Array; port: MessagePort };
let runs = 0;

port.on("message", async (args: string[]) => {
  const printed = { stdout: "", stderr: "" };
  for (const name of ["stdout", "stderr"] as const) {
    process[name].removeAllListeners();
    process[name].write = (text: string | Uint8Array) => {
      printed[name] += typeof text === "string" ? text : Buffer.from(text).toString();
      return true;
    };
  }
  process.argv = [process.execPath, fileURLToPath(commandLine), ...args];
  process.exitCode = undefined;

  // A module with another address is run again; what it imports is not.
  runs += 1;
  await import(`${commandLine}?${runs}`);

  port.postMessage({ status: process.exitCode ?? 0, ...printed });
  Atomics.store(done, 0, 1);
  Atomics.notify(done, 0);
});
