/** The results as JSON Lines: the record of a batch, from which it can be resumed. */
import { appendFileSync, closeSync, createReadStream, openSync, readSync, statSync, truncateSync } from "node:fs";
import { createInterface } from "node:readline";
import { isRecord } from "../values/values.js";
import { contentHash, pathIn, recordedPath } from "./case-identity.js";
import { LineFile } from "./line-file.js";
import { lockRecord } from "./record-lock.js";
import { UsageError } from "./usage-error.js";
import { checkWritable } from "./writable.js";

/** What a case is: its name, and where it is. */
export interface CaseKey {
  /** For people, and for the other files. It depends on the other cases of a batch. */
  name: string;
  /** Its absolute path, by which a record knows it; without one, it is known by its name. */
  path?: string | undefined;
  /** Its folder, if it is one: its content tells it where it has moved. */
  folder?: string | undefined;
}

/** The JSON entry of a case in a record. */
export interface RecordedEntry {
  name: string;
  /** Its absolute path, and the checksum of its inputs. */
  path?: string | undefined;
  content?: string | undefined;
  entry: Readonly<Record<string, unknown>>;
}

/** The first bytes of every line. */
const START = '{"case":';
const NEWLINE = 0x0a;

/**
 * A line for each case: its entry, preceded by `case`, its name, `path`, its path relative to the record, and `content`, a
 * checksum of its inputs.
 */
export class JsonlFile {
  readonly #path: string;
  readonly #lines: LineFile;
  readonly #release: () => void = () => {};

  /**
   * @param isResumed whether the lines of the file are kept
   * @throws {@link UsageError} if the file cannot be written, if another process writes it, or if it holds lines that are
   * not to be kept
   */
  constructor(path: string, isResumed: boolean) {
    const isFile = path !== "-" && checkWritable("--jsonl", path);
    if (isResumed && !isFile) throw new UsageError(`--resume needs a file: --jsonl ${path} is none.`);
    if (isFile) this.#release = lockRecord("--jsonl", path);
    if (isFile && !isResumed && (statSync(path, { throwIfNoEntry: false })?.size ?? 0) > 0) {
      throw new UsageError(`--jsonl ${path}: the file has content. Pass --resume to go on, or remove the file.`);
    }
    this.#path = path;
    this.#lines = new LineFile(path, "a");
  }

  add({ name, path, folder }: CaseKey, entry: object): void {
    const recorded = path === undefined ? undefined : recordedPath(this.#path, path);
    const content = folder === undefined ? undefined : contentHash(folder);
    this.#lines.append([JSON.stringify({ case: name, path: recorded, content, ...entry })]);
  }

  end(): void {
    this.#lines.end();
    this.#release();
  }

  /**
   * The entries in the file, each case once. A last line that was not written to its end is removed.
   * @throws {@link UsageError} for a file with other content, which stays as it is
   */
  async *entries(): AsyncGenerator<RecordedEntry, void, undefined> {
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
      const found = this.#parsed(line);
      if (found === undefined) throw this.#foreign(number);
      const key = found.path ?? found.name;
      if (!seen.has(key)) yield found;
      seen.add(key);
    }
    if (text === "") return;
    const last = this.#parsed(text);
    if (last === undefined && !text.startsWith(START.slice(0, text.length))) throw this.#foreign(number + 1);
    if (last === undefined) {
      truncateSync(this.#path, start);
      return;
    }
    // Only the line break is missing.
    appendFileSync(this.#path, "\n");
    if (!seen.has(last.path ?? last.name)) yield last;
  }

  #foreign(line: number): UsageError {
    const expected = 'an object with "case", as --jsonl writes them';
    return new UsageError(
      `--jsonl ${this.#path}: line ${line} is not ${expected}. Remove the line, or pass another file.`,
    );
  }

  #parsed(line: string): RecordedEntry | undefined {
    try {
      const value: unknown = JSON.parse(line);
      if (!isRecord(value) || typeof value.case !== "string") return undefined;
      const { case: name, path, content, ...entry } = value;
      return {
        name: name as string,
        path: typeof path === "string" ? pathIn(this.#path, path) : undefined,
        content: typeof content === "string" ? content : undefined,
        entry,
      };
    } catch {
      return undefined;
    }
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
