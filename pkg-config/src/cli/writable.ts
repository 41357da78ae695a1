/** Output files and folders, checked before the work whose results they get. */
import { accessSync, closeSync, constants, mkdirSync, openSync, readSync, statSync, writeSync } from "node:fs";
import { dirname } from "node:path";
import { UsageError } from "./usage-error.js";

/**
 * Checks that a file can be written, without writing it.
 * @param flag the flag that names the file, for errors
 * @returns whether it is, or will be, an ordinary file; not a pipe or a device
 * @throws {@link UsageError}
 */
export function checkWritable(flag: string, path: string): boolean {
  try {
    const found = statSync(path, { throwIfNoEntry: false });
    if (found?.isDirectory()) throw new UsageError(`${flag} ${path}: this is a folder; pass the name of a file.`);
    if (found === undefined && !statSync(dirname(path)).isDirectory()) throw new Error(`${dirname(path)} is no folder`);
    accessSync(found === undefined ? dirname(path) : path, constants.W_OK);
    return found === undefined || found.isFile();
  } catch (error) {
    if (error instanceof UsageError) throw error;
    throw new UsageError(`${flag} ${path}: the file cannot be written: ${(error as Error).message}.`);
  }
}

/**
 * Creates a folder for output.
 * @param flag the flag that names the folder, for errors
 * @throws {@link UsageError}
 */
export function makeFolder(flag: string, path: string): void {
  try {
    if (statSync(path, { throwIfNoEntry: false })?.isFile()) throw new Error("it is a file");
    mkdirSync(path, { recursive: true });
  } catch (error) {
    throw new UsageError(`${flag} ${path}: the folder cannot be made: ${(error as Error).message}.`);
  }
}

/**
 * Refuses to replace a file that is not the output of an earlier run: it may be the input.
 * @param isOwn whether the beginning of a file is that of such an output
 * @throws {@link UsageError}
 */
export function checkReplaceable(flag: string, path: string, isOwn: (beginning: string) => boolean): void {
  const bytes = Buffer.alloc(4096);
  let length: number;
  try {
    const file = openSync(path, "r");
    try {
      length = readSync(file, bytes, 0, bytes.length, 0);
    } finally {
      closeSync(file);
    }
  } catch {
    // There is none, or it cannot be read, and so is no input.
    return;
  }
  if (length === 0 || isOwn(bytes.toString("utf8", 0, length))) return;
  throw new UsageError(`${flag} ${path}: this file was not written by ${flag}. Remove it, or pass another name.`);
}

/**
 * Runs what writes a file.
 * @throws {@link UsageError} that names the file, such as where no space is left
 */
export function writing<T>(path: string, write: () => T): T {
  try {
    return write();
  } catch (cause) {
    throw new UsageError(`${path}: cannot be written: ${(cause as Error).message}.`, { cause });
  }
}

/** Writes all bytes, at a position or, with `null`, at the current one. */
export function writeAll(file: number, bytes: Buffer, position: number | null): void {
  for (let written = 0; written < bytes.length; ) {
    written += writeSync(file, bytes, written, bytes.length - written, position === null ? null : position + written);
  }
}
