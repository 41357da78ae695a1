/** The examples as they are installed, and how they are run. */
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { required } from "./environment.js";
import { obj, viewFiles, writeFiles } from "./files.js";
import { mesh, pinhole, render, truth } from "./scene.js";

/** The folder of the examples, a copy of the repository's with its packages installed. */
export const examplesDir = required("SIM3ALIGN_EXAMPLES");

/** The output of a script, and its exit status. */
type Outcome = { status: number; stdout: string; stderr: string };

/**
 * Runs an example's script to its end, in its own folder.
 * @param script such as `01-one-call/align.mjs`
 */
export function runExample(script: string, args: string[] = [], env: NodeJS.ProcessEnv = {}): Promise<Outcome> {
  const [folder = "", file = ""] = script.split("/");
  const options = { cwd: join(examplesDir, folder), env: { ...process.env, ...env }, maxBuffer: 1 << 26 };
  return new Promise((resolve) => {
    execFile(process.execPath, [file, ...args], options, (error, stdout, stderr) => {
      const status = error === null ? 0 : typeof error.code === "number" ? error.code : -1;
      resolve({ status, stdout, stderr });
    });
  });
}

/** Runs an example's script, which has to succeed, and returns what it prints. */
export async function printedBy(script: string, args: string[] = [], env: NodeJS.ProcessEnv = {}): Promise<string> {
  const { status, stdout, stderr } = await runExample(script, args, env);
  assert.equal(status, 0, stderr);
  return stdout;
}

/** Writes a case of the test scene, and returns its folder; an empty mask is an error. */
export function writeCase(parent: string, name: string, { pose = truth, isEmpty = false } = {}): string {
  const view = render(mesh, pose, pinhole, 160, 120);
  if (isEmpty) view.mask.fill(0);
  return writeFiles(join(parent, name), { ...viewFiles(view), "mesh.obj": obj(mesh) });
}

/** A case's files, as bytes. */
export function filesOf(folder: string) {
  const read = (name: string) => readFileSync(join(folder, name));
  const mesh = read(existsSync(join(folder, "mesh.glb")) ? "mesh.glb" : "mesh.obj");
  return { depth: read("depth.npy"), mask: read("mask.png"), cameraFile: read("camera.json"), mesh };
}

/** A new folder for what an example writes, gone when the test's process ends. */
export function newFolder(): string {
  const folder = mkdtempSync(join(tmpdir(), "sim3align-example-"));
  process.on("exit", () => rmSync(folder, { recursive: true, force: true }));
  return folder;
}

/**
 * A program that a test needs beside Node.
 * @param variable what the test script names it in
 * @returns its path, and what `test` takes as `skip`: in continuous integration nothing is skipped, but fails
 */
export function program(variable: string, name: string, remedy: string): { path: string; skip: string | false } {
  const path = process.env[variable] ?? "";
  if (path !== "" || process.env.CI) return { path, skip: false };
  return { path, skip: `No ${name}. Remedy: ${remedy}, or name it in ${variable}.` };
}
