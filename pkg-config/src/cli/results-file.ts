/** The JSON of the results, which is complete after each case: an interruption loses no result. */
import { accessSync, closeSync, constants, openSync, statSync, writeSync } from "node:fs";
import { dirname } from "node:path";
import { UsageError } from "./usage-error.js";

const END = "\n}\n";

/** An object with an entry for each case, in a file or on stdout. */
export class ResultsFile {
  readonly #path: string;
  /** Whether entries are written as they come. Pipes and devices get all of them at the end. */
  readonly #isIncremental: boolean;
  #entries: string[] = [];
  #file: number | undefined;
  /** Bytes of the file before its end. */
  #length = 0;

  /**
   * Writes nothing yet: a file that exists keeps its content until the first entry.
   * @param path a file; "-" is stdout
   * @throws {@link UsageError} if the file cannot be written
   */
  constructor(path: string) {
    this.#path = path;
    this.#isIncremental = path !== "-" && checkWritable(path);
  }

  /**
   * Adds the entry of a case.
   * @param isFinal whether no other entry will replace it
   */
  add(name: string, entry: object, isFinal = true): void {
    if (!this.#isIncremental && !isFinal) return;
    const text = `  ${JSON.stringify(name)}: ${JSON.stringify(entry, null, 2).replaceAll("\n", "\n  ")}`;
    if (!this.#isIncremental) {
      this.#entries.push(text);
      return;
    }
    const isFirst = this.#length === 0;
    this.#file ??= openSync(this.#path, "w");
    const bytes = Buffer.from(`${isFirst ? "{\n" : ",\n"}${text}${END}`);
    writeAll(this.#file, bytes, this.#length);
    if (isFinal) this.#length += bytes.length - END.length;
  }

  /** Writes what is not written yet. */
  end(): void {
    if (this.#file !== undefined) closeSync(this.#file);
    this.#file = undefined;
    if (this.#isIncremental) return;
    const text = `{\n${this.#entries.join(",\n")}${END}`;
    this.#entries = [];
    if (this.#path === "-") {
      process.stdout.write(text);
      return;
    }
    const file = openSync(this.#path, "w");
    writeAll(file, Buffer.from(text), null);
    closeSync(file);
  }
}

function writeAll(file: number, bytes: Buffer, position: number | null): void {
  for (let written = 0; written < bytes.length; ) {
    written += writeSync(file, bytes, written, bytes.length - written, position === null ? null : position + written);
  }
}

/** Checks that a file can be written, without writing it; whether it is, or will be, an ordinary file. */
function checkWritable(path: string): boolean {
  try {
    const found = statSync(path, { throwIfNoEntry: false });
    if (found?.isDirectory()) throw new UsageError(`--json ${path}: this is a folder; pass the name of a file.`);
    if (found === undefined && !statSync(dirname(path)).isDirectory()) throw new Error(`${dirname(path)} is no folder`);
    accessSync(found === undefined ? dirname(path) : path, constants.W_OK);
    return found === undefined || found.isFile();
  } catch (error) {
    if (error instanceof UsageError) throw error;
    throw new UsageError(`--json ${path}: the file cannot be written: ${(error as Error).message}.`);
  }
}
