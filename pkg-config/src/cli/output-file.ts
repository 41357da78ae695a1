/** Output files, which are written whole or not at all, and their folders. */
import {
  accessSync,
  closeSync,
  constants,
  fstatSync,
  ftruncateSync,
  mkdirSync,
  openSync,
  renameSync,
  rmSync,
  statSync,
  writeSync,
} from "node:fs";
import { dirname, join } from "node:path";
import { isOrdinary, realPath, statOf, UsageError } from "./files.js";

/** An output that cannot be written whole. */
export class OutputError extends Error {}

let parts = 0;

/**
 * A file that takes the place of an earlier one when it is closed; until then, its content is in a file beside it. Stdout
 * ("-"), pipes and devices are written at once.
 */
export class OutputFile {
  #file: number | undefined;
  #isClosed = false;
  readonly #part: string | undefined;
  readonly #place: string;

  /**
   * @param isAppended whether lines are added to the file itself
   * @param onEnd called when the content is in its place
   */
  constructor(
    private readonly path: string,
    private readonly isAppended = false,
    private readonly onEnd = () => {},
  ) {
    // A link stays, and leads to the new content.
    this.#place = path === "-" ? path : realPath(path);
    if (!isAppended && isOrdinary(path))
      this.#part = join(dirname(this.#place), `.sim3align-${process.pid}-${++parts}.part`);
  }

  /**
   * Adds content, of which nothing is left if it cannot be written.
   * @throws {@link OutputError} that names the file, such as where no space is left
   */
  write(content: string | Uint8Array): void {
    if (this.#isClosed) return;
    if (this.path === "-") {
      process.stdout.write(content);
      return;
    }
    this.#try(() => {
      const file = this.#opened();
      const bytes = typeof content === "string" ? Buffer.from(content) : content;
      const before = this.isAppended ? fstatSync(file).size : undefined;
      try {
        for (let written = 0; written < bytes.length; )
          written += writeSync(file, bytes, written, bytes.length - written);
      } catch (error) {
        if (before !== undefined) ftruncateSync(file, before);
        throw error;
      }
    });
  }

  /** Writes lines, at once: another program that follows the file reads whole ones. */
  lines(lines: readonly string[]): void {
    this.write(lines.map((line) => `${line}\n`).join(""));
  }

  /** Puts the content in its place. */
  end(): void {
    if (this.path === "-" || this.#isClosed || (this.isAppended && this.#file === undefined)) return;
    this.#try(() => {
      closeSync(this.#opened());
      [this.#file, this.#isClosed] = [undefined, true];
      if (this.#part !== undefined) renameSync(this.#part, this.#place);
      this.onEnd();
    });
  }

  /** Leaves an earlier file as it is. */
  discard(): void {
    this.#isClosed = true;
    if (this.#file !== undefined) closeSync(this.#file);
    this.#file = undefined;
    if (this.#part !== undefined) rmSync(this.#part, { force: true });
  }

  #opened(): number {
    this.#file ??= openSync(this.#part ?? this.path, this.isAppended ? "a" : "w");
    return this.#file;
  }

  #try(act: () => void): void {
    try {
      act();
    } catch (cause) {
      try {
        this.discard();
      } catch {
        // The first error is that of the file.
      }
      throw new OutputError(`${this.path}: cannot be written: ${(cause as Error).message}.`, { cause });
    }
  }
}

/** @throws {@link UsageError} for an output that cannot be written */
export function checkWritable(flag: string, path: string): void {
  if (path === "-") return;
  try {
    const found = statOf(path);
    if (found?.isDirectory()) throw new UsageError(`${flag} ${path}: this is a folder; pass the name of a file.`);
    const folder = dirname(realPath(path));
    if (found === undefined && !statSync(folder).isDirectory()) throw new Error(`${folder} is no folder`);
    accessSync(isOrdinary(path) ? folder : path, constants.W_OK);
  } catch (error) {
    if (error instanceof UsageError) throw error;
    throw new UsageError(`${flag} ${path}: the file cannot be written: ${(error as Error).message}.`);
  }
}

/**
 * Creates a folder for output.
 * @throws {@link OutputError}
 */
export function makeFolder(flag: string, path: string): void {
  try {
    mkdirSync(path, { recursive: true });
  } catch (error) {
    throw new OutputError(`${flag} ${path}: the folder cannot be made: ${(error as Error).message}.`);
  }
}
