/** The command line, run as its users run it, in a folder of cases. */
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after } from "node:test";
import { commandLine } from "./environment.js";
import { glb, npy, png } from "./files.js";
import { mesh, view } from "./scene.js";

const { width, height, depth, mask, camera } = view;

/** The folder of the cases, removed after the tests of a file. */
export const folder = mkdtempSync(join(tmpdir(), "sim3align-cli-"));
after(() => rmSync(folder, { recursive: true, force: true }));

/** Runs the command line in the folder of the cases. */
export function run(...args: string[]): { status: number | null; stdout: string; stderr: string } {
  const { status, stdout, stderr } = spawnSync(process.execPath, [commandLine, ...args], {
    cwd: folder,
    encoding: "utf8",
  });
  return { status, stdout, stderr };
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
export function writeCase(name: string, files: Record<string, Uint8Array | object>): string {
  mkdirSync(join(folder, name), { recursive: true });
  for (const [file, content] of Object.entries(files)) {
    const text = content instanceof Uint8Array ? content : JSON.stringify(content);
    writeFileSync(join(folder, name, file), text);
  }
  return name;
}

/** The mask of the scene as a file. */
export const pixels = png(
  mask.map((m) => 255 * m),
  width,
  height,
);

/** The files of the scene. */
export const files = {
  "depth.npy": npy(depth, height, width),
  "mask.png": pixels,
  "mesh.glb": glb(mesh),
  "camera.json": camera,
};

/** The results that --json wrote. */
export const results = (path: string) => JSON.parse(readFileSync(join(folder, path), "utf8"));

/** A case that never ends: nobody writes to its depth map. */
export function endless(name: string): string {
  const { "depth.npy": _, ...others } = files;
  writeCase(name, others);
  assert.equal(spawnSync("mkfifo", [join(folder, name, "depth.npy")]).status, 0);
  return name;
}
