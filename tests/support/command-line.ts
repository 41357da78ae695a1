/** The command line, run as its users run it, in a folder of cases. */
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after } from "node:test";
import { pathToFileURL } from "node:url";
import { MessageChannel, receiveMessageOnPort, SHARE_ENV, Worker } from "node:worker_threads";
import { commandLine, installDir } from "./environment.js";
import { type Files, glb, viewFiles, writeFiles } from "./files.js";
import { mesh, view } from "./scene.js";

/** The folder of the cases, removed after the tests of a file. It is the working directory, for threads share it. */
export const folder = mkdtempSync(join(tmpdir(), "sim3align-cli-"));
process.chdir(folder);
after(() => {
  process.chdir(installDir);
  rmSync(folder, { recursive: true, force: true });
});

interface Run {
  status: number | null;
  stdout: string;
  stderr: string;
}

const { NODE_OPTIONS } = process.env;
const done = new Int32Array(new SharedArrayBuffer(4));
const { port1: port, port2 } = new MessageChannel();
let host: Worker | undefined;

/**
 * Runs the command line in the folder of the cases. The first argument may be several words. All runs of a file of tests are in
 * one thread, but for those whose file system has faults: starting Node would take most of their time.
 */
export function run(...args: string[]): Run {
  const [words = "", ...more] = args;
  const all = [...words.split(" ").filter(Boolean), ...more];
  if (process.env.NODE_OPTIONS !== NODE_OPTIONS) return runAlone(...all);

  const workerData = { commandLine: pathToFileURL(commandLine).href, done, port: port2 };
  host ??= new Worker(new URL("command-host.js", import.meta.url), {
    env: SHARE_ENV,
    workerData,
    transferList: [port2],
  });
  host.unref();
  Atomics.store(done, 0, 0);
  port.postMessage(all);
  Atomics.wait(done, 0, 0);
  return receiveMessageOnPort(port)?.message;
}

/** Runs the command line in a process of its own. */
export function runAlone(...args: string[]): Run {
  const { status, stdout, stderr } = spawnSync(process.execPath, [commandLine, ...args], { encoding: "utf8" });
  return { status, stdout, stderr };
}

/** Runs a line of a POSIX shell in the folder of the cases. */
export const shell = (line: string, env = process.env) =>
  spawnSync("sh", ["-c", line], { cwd: folder, encoding: "utf8", env });

/** Runs the command line, which has to succeed. */
export function succeeds(...args: string[]): { stdout: string; stderr: string } {
  const { status, ...printed } = run(...args);
  assert.equal(status, 0, printed.stderr);
  return printed;
}

/** Checks that command lines are refused as wrong usage, before anything is written to stdout, with these messages. */
export function refusesUsage(messages: Record<string, RegExp>): void {
  for (const [words, message] of Object.entries(messages)) {
    const { status, stdout, stderr } = run(words);
    assert.equal(status, 2, `${words}: ${stderr}`);
    assert.match(stderr, message, words);
    assert.equal(stdout, "", words);
  }
}

/** Runs the command line until it has written some text to stdout, and then sends it a signal. */
export function interrupted(text: RegExp, signal: NodeJS.Signals, ...args: string[]) {
  const child = spawn(process.execPath, [commandLine, ...args], { cwd: folder });
  let [stdout, stderr] = ["", ""];
  child.stdout.on("data", (chunk) => {
    const isSent = text.test(stdout);
    stdout += chunk;
    if (!isSent && text.test(stdout)) child.kill(signal);
  });
  child.stderr.on("data", (chunk) => {
    stderr += chunk;
  });
  return new Promise<{ signal: string | null; stdout: string; stderr: string }>((resolve) => {
    child.on("close", (_, ended) => resolve({ signal: ended, stdout, stderr }));
  });
}

/** Writes the files of a case, and returns its name. */
export function writeCase(name: string, files: Files): string {
  writeFiles(join(folder, name), files);
  return name;
}

/** The files of the scene. */
export const files = { ...viewFiles(view), "mesh.glb": glb(mesh) };

/** The mask of the scene as a file. */
export const pixels = files["mask.png"];

/** The text of a file in the folder of the cases. */
export const read = (path: string) => readFileSync(join(folder, path), "utf8");

/** The results that --json wrote. */
export const results = (path: string) => JSON.parse(read(path));

/**
 * Lets the file system of later runs have faults, until the returned function is called: what is below `hanging` is never
 * read, and files below `full` get their first bytes only, as on a disk without space.
 */
export function withFaults(faults: { hanging?: string; full?: string }): () => void {
  const program = `
    import fs from "node:fs";
    import { syncBuiltinESMExports } from "node:module";
    const { hanging, full } = ${JSON.stringify(faults)};
    const isBelow = (path, name) => name !== undefined && String(path).split(/[\\\\/]/).includes(name);
    const { openSync, writeSync } = fs;
    const { stat } = fs.promises;
    fs.promises.stat = (path, ...more) =>
      isBelow(path, hanging) ? new Promise(() => setInterval(() => {}, 1000)) : stat(path, ...more);
    const files = new Set();
    fs.openSync = (path, ...more) => {
      const file = openSync(path, ...more);
      if (isBelow(path, full)) files.add(file);
      else files.delete(file);
      return file;
    };
    fs.writeSync = (file, bytes, offset, length, ...more) => {
      if (!files.has(file)) return writeSync(file, bytes, offset, length, ...more);
      if (offset > 0) throw Object.assign(new Error("ENOSPC: no space left on device, write"), { code: "ENOSPC" });
      return writeSync(file, bytes, offset, 7, ...more);
    };
    syncBuiltinESMExports();
  `;
  const before = process.env.NODE_OPTIONS;
  process.env.NODE_OPTIONS = `--import=data:text/javascript;base64,${Buffer.from(program).toString("base64")}`;
  return () => {
    if (before === undefined) delete process.env.NODE_OPTIONS;
    else process.env.NODE_OPTIONS = before;
  };
}
