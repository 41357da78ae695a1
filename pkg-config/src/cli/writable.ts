/** Output files, checked before the work whose results they get. */
import { accessSync, constants, statSync, writeSync } from "node:fs";
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

/** Writes all bytes, at a position or, with `null`, at the current one. */
export function writeAll(file: number, bytes: Buffer, position: number | null): void {
  for (let written = 0; written < bytes.length; ) {
    written += writeSync(file, bytes, written, bytes.length - written, position === null ? null : position + written);
  }
}
