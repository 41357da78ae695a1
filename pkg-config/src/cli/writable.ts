/** Output files and folders, checked before the work whose results they get. */
import { accessSync, constants, mkdirSync, statSync, writeSync } from "node:fs";
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

/** Writes all bytes, at a position or, with `null`, at the current one. */
export function writeAll(file: number, bytes: Buffer, position: number | null): void {
  for (let written = 0; written < bytes.length; ) {
    written += writeSync(file, bytes, written, bytes.length - written, position === null ? null : position + written);
  }
}
