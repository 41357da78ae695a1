/** The command line, run as its users run it, in a folder of cases. */
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after } from "node:test";
import { commandLine } from "./environment.js";
import { type Files, glb, viewFiles, writeFiles } from "./files.js";
import { mesh, view } from "./scene.js";

/** The folder of the cases, removed after the tests of a file. */
export const folder = mkdtempSync(join(tmpdir(), "sim3align-cli-"));
after(() => rmSync(folder, { recursive: true, force: true }));

/** Runs the command line in the folder of the cases. The first argument may be several words. */
export function run(...args: string[]): { status: number | null; stdout: string; stderr: string } {
  const [words = "", ...more] = args;
  const all = [commandLine, ...words.split(" ").filter(Boolean), ...more];
  const { status, stdout, stderr } = spawnSync(process.execPath, all, { cwd: folder, encoding: "utf8" });
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
    stdout += chunk;
    if (text.test(stdout)) child.kill(signal);
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

/** A case that never ends: nobody writes to its depth map. */
export function endless(name: string): string {
  const { "depth.npy": _, ...others } = files;
  writeCase(name, others);
  assert.equal(spawnSync("mkfifo", [join(folder, name, "depth.npy")]).status, 0);
  return name;
}
