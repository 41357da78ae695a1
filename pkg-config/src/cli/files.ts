/** Files and folders on the command line: checks before a run, and output during it. */
import {
  accessSync,
  closeSync,
  constants,
  mkdirSync,
  openSync,
  readdirSync,
  readFileSync,
  readSync,
  statSync,
  writeSync,
} from "node:fs";
import { dirname } from "node:path";

/** An invalid command line, which ends the program. */
export class UsageError extends Error {}

/** The names in a folder; none if it cannot be read. */
export function namesIn(folder: string): string[] {
  try {
    return readdirSync(folder).sort();
  } catch {
    return [];
  }
}

/**
 * The text of the file that a flag names.
 * @throws {@link UsageError} if it cannot be read
 */
export function textOf(flag: string, path: string): string {
  try {
    return readFileSync(path, "utf8");
  } catch (error) {
    throw new UsageError(`${flag} ${path}: the file cannot be read: ${(error as Error).message}.`);
  }
}

/** The bytes of a file at a position, at most `length`. */
export function bytesOf(path: string, position: number, length: number): Buffer {
  const file = openSync(path, "r");
  try {
    const bytes = Buffer.alloc(length);
    return bytes.subarray(0, readSync(file, bytes, 0, length, position));
  } finally {
    closeSync(file);
  }
}

/** Whether a path is an ordinary file. */
export const isFile = (path: string) => statSync(path, { throwIfNoEntry: false })?.isFile() === true;

/** Whether a path is, or will be, an ordinary file; not stdout ("-"), a pipe or a device. */
export const isOrdinary = (path: string) =>
  path !== "-" && statSync(path, { throwIfNoEntry: false })?.isFile() !== false;

/**
 * Checks that a file can be written, without writing it.
 * @param flag the flag that names the file, for errors
 * @throws {@link UsageError}
 */
export function checkWritable(flag: string, path: string): void {
  if (path === "-") return;
  try {
    const found = statSync(path, { throwIfNoEntry: false });
    if (found?.isDirectory()) throw new UsageError(`${flag} ${path}: this is a folder; pass the name of a file.`);
    if (found === undefined && !statSync(dirname(path)).isDirectory()) throw new Error(`${dirname(path)} is no folder`);
    accessSync(found === undefined ? dirname(path) : path, constants.W_OK);
  } catch (error) {
    if (error instanceof UsageError) throw error;
    throw new UsageError(`${flag} ${path}: the file cannot be written: ${(error as Error).message}.`);
  }
}

/**
 * Creates a folder for output.
 * @throws {@link UsageError}
 */
export function makeFolder(flag: string, path: string): void {
  try {
    if (isFile(path)) throw new Error("it is a file");
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
  if (!isOrdinary(path)) return;
  let beginning = "";
  try {
    beginning = bytesOf(path, 0, 4096).toString();
  } catch {
    // There is no file, or it cannot be read and so is no input.
  }
  if (beginning === "" || isOwn(beginning)) return;
  throw new UsageError(`${flag} ${path}: this file was not written by ${flag}. Remove it, or pass another name.`);
}

/** A file, pipe or stdout ("-"). It is opened by what is written first: until then, it keeps its content. */
export class OutputFile {
  #file: number | undefined;

  /** @param mode whether texts are appended to the file or replace its content */
  constructor(
    private readonly path: string,
    private readonly mode: "a" | "w",
  ) {}

  /**
   * Writes a text, at a position or, by default, after the last one.
   * @throws {@link UsageError} that names the file, such as where no space is left
   */
  write(text: string, position: number | null = null): void {
    if (this.path === "-") {
      process.stdout.write(text);
      return;
    }
    try {
      this.#file ??= openSync(this.path, this.mode);
      const bytes = Buffer.from(text);
      for (let written = 0; written < bytes.length; ) {
        const at = position === null ? null : position + written;
        written += writeSync(this.#file, bytes, written, bytes.length - written, at);
      }
    } catch (cause) {
      throw new UsageError(`${this.path}: cannot be written: ${(cause as Error).message}.`, { cause });
    }
  }

  /** Writes lines, at once: another program that follows the file reads whole ones. */
  lines(lines: readonly string[]): void {
    this.write(lines.map((line) => `${line}\n`).join(""));
  }

  end(): void {
    if (this.#file !== undefined) closeSync(this.#file);
    this.#file = undefined;
  }
}
