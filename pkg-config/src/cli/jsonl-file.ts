/** The results as JSON Lines: the record of a batch, from which it can be resumed. */
import { appendFileSync, closeSync, createReadStream, openSync, readSync, statSync, truncateSync } from "node:fs";
import { createInterface } from "node:readline";
import { isRecord } from "../values.js";
import { LineFile } from "./line-file.js";
import { UsageError } from "./usage-error.js";
import { checkWritable } from "./writable.js";

/** The JSON entry of a case, with its name. */
export interface NamedEntry {
  name: string;
  entry: Readonly<Record<string, unknown>>;
}

/** The first bytes of every line. */
const START = '{"case":';
const NEWLINE = 0x0a;

/** A line for each case: its entry, preceded by `case`, its name. */
export class JsonlFile {
  readonly #path: string;
  readonly #lines: LineFile;

  /**
   * @param isResumed whether the lines of the file are kept
   * @throws {@link UsageError} if the file cannot be written, or if it holds lines that are not to be kept
   */
  constructor(path: string, isResumed: boolean) {
    const isFile = path !== "-" && checkWritable("--jsonl", path);
    if (isResumed && !isFile) throw new UsageError(`--resume needs a file: --jsonl ${path} is none.`);
    if (isFile && !isResumed && (statSync(path, { throwIfNoEntry: false })?.size ?? 0) > 0) {
      throw new UsageError(`--jsonl ${path}: the file has content. Pass --resume to go on, or remove the file.`);
    }
    this.#path = path;
    this.#lines = new LineFile(path, "a");
  }

  add(name: string, entry: object): void {
    this.#lines.append([JSON.stringify({ case: name, ...entry })]);
  }

  end(): void {
    this.#lines.end();
  }

  /**
   * The entries in the file, each case once. A last line that was not written to its end is removed.
   * @throws {@link UsageError} for a file with other content, which stays as it is
   */
  async *entries(): AsyncGenerator<NamedEntry, void, undefined> {
    const size = statSync(this.#path, { throwIfNoEntry: false })?.size ?? 0;
    if (size === 0) return;
    const { start, text } = lastLine(this.#path, size);
    const seen = new Set<string>();
    let number = 0;
    const lines =
      start === 0
        ? []
        : createInterface({ input: createReadStream(this.#path, { end: start - 1 }), crlfDelay: Infinity });
    for await (const line of lines) {
      number += 1;
      if (line.trim() === "") continue;
      const named = parsed(line);
      if (named === undefined) throw this.#foreign(number);
      if (!seen.has(named.name)) yield named;
      seen.add(named.name);
    }
    if (text === "") return;
    const last = parsed(text);
    if (last === undefined && !text.startsWith(START.slice(0, text.length))) throw this.#foreign(number + 1);
    if (last === undefined) {
      truncateSync(this.#path, start);
      return;
    }
    // Only the line break is missing.
    appendFileSync(this.#path, "\n");
    if (!seen.has(last.name)) yield last;
  }

  #foreign(line: number): UsageError {
    const expected = 'an object with "case", as --jsonl writes them';
    return new UsageError(
      `--jsonl ${this.#path}: line ${line} is not ${expected}. Remove the line, or pass another file.`,
    );
  }
}

function parsed(line: string): NamedEntry | undefined {
  try {
    const value: unknown = JSON.parse(line);
    if (!isRecord(value) || typeof value.case !== "string") return undefined;
    const { case: name, ...entry } = value;
    return { name: name as string, entry };
  } catch {
    return undefined;
  }
}

/** What follows the last line break of a file. */
function lastLine(path: string, size: number): { start: number; text: string } {
  const file = openSync(path, "r");
  try {
    const parts: Buffer[] = [];
    for (let end = size; end > 0; ) {
      const begin = Math.max(0, end - 65_536);
      const part = Buffer.alloc(end - begin);
      if (readSync(file, part, 0, part.length, begin) < part.length) throw new Error(`${path} became shorter.`);
      const found = part.lastIndexOf(NEWLINE);
      parts.unshift(part.subarray(found + 1));
      if (found >= 0) return { start: begin + found + 1, text: Buffer.concat(parts).toString() };
      end = begin;
    }
    return { start: 0, text: Buffer.concat(parts).toString() };
  } finally {
    closeSync(file);
  }
}
