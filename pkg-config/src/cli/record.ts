/** The record of a batch, from which it can be resumed: a line with its settings, and a line of JSON for each case. */
import { createHash } from "node:crypto";
import { appendFileSync, createReadStream, existsSync, readFileSync, truncateSync } from "node:fs";
import { basename, dirname, join, relative, sep } from "node:path";
import { createInterface } from "node:readline";
import { isDeepStrictEqual } from "node:util";
import { partOf } from "../case-names.js";
import { isRecord } from "../values/kinds.js";
import type { Entry } from "./entry.js";
import { absolutePath, bytesOf, isFile, isOrdinary, namesIn, partsOf, realPath, statOf, UsageError } from "./files.js";
import { OutputFile } from "./output-file.js";
import { lockRecord, type RecordLock } from "./record-lock.js";

/** The version of the package. */
export const { version } = JSON.parse(readFileSync(new URL("../package.json", import.meta.url), "utf8")) as {
  version: string;
};

/** The identity of a case. */
export interface CaseKey {
  /** For people, and for the other files. It depends on the other cases of a batch. */
  name: string;
  /** Its absolute path, the key in a record; without a path, the name is the key. */
  path?: string | undefined;
  /** Its folder, if it is one: a case that has moved is recognised by the content. */
  folder?: string | undefined;
}

/** The entry of a case in a record. */
interface RecordedEntry {
  name: string;
  /** Its absolute path, and the checksum of its inputs. */
  path?: string | undefined;
  content?: string | undefined;
  entry: Entry;
}

/** An entry of the record of a batch, with the case of the batch and the name of that case. */
export interface Resumed<T extends CaseKey> extends Pick<RecordedEntry, "name" | "entry"> {
  task: T | undefined;
}

const keyOf = ({ path, name }: Pick<CaseKey, "path" | "name">) => path ?? name;

/** The settings that the results of a record depend on beside the cases; `pathOf` returns the paths of files as the record has them. */
export type RecordHeader = (pathOf: (path: string) => string) => { command: string; options: Record<string, unknown> };

/** A checksum of the inputs in a folder: its files, those of its frames and of its objects. `undefined` without files. */
function contentHash(folder: string): string | undefined {
  // A true pose only measures errors.
  const isInput = (path: string) => ![undefined, "truth"].includes(partOf(basename(path))) && isFile(path);
  const hash = createHash("sha256");
  let isEmpty = true;
  for (const path of partsOf(folder).flatMap((part) => namesIn(part).map((name) => join(part, name)))) {
    try {
      if (!isInput(path)) continue;
      const bytes = readFileSync(path);
      hash.update(`${relative(folder, path).split(sep).join("/")} ${bytes.length}\n`).update(bytes);
      isEmpty = false;
    } catch {
      // What cannot be read is reported for the case.
    }
  }
  return isEmpty ? undefined : hash.digest("hex").slice(0, 32);
}

/** The first bytes of the lines of cases, and of the first line. */
const STARTS = ['{"case":', '{"sim3align":'];
const NEWLINE = 0x0a;

/**
 * A line with `sim3align`, the version, `command` and `options`, and a line for each case: its entry, preceded by `case`, its name, `path`, its path relative to the record, and `content`, a
 * checksum of its inputs.
 */
export class JsonlFile {
  /** The folder to which paths are relative; that of stdout is the current one. */
  readonly #folder: string;
  readonly #file: OutputFile;
  readonly #header: Readonly<Record<string, unknown>>;
  #isBegun = false;
  readonly #lock: RecordLock | undefined;
  /** The keys of the cases in the file. */
  readonly #keys = new Set<string>();

  /**
   * @param isResumed whether the lines of the file are kept
   * @throws {@link UsageError} if another process writes the file, or if it holds lines that are not to be kept
   */
  constructor(
    private readonly path: string,
    isResumed: boolean,
    header: RecordHeader,
  ) {
    const ordinary = isOrdinary(path);
    if (isResumed && !ordinary) throw new UsageError(`--resume needs a file: --jsonl ${path} is none.`);
    this.#folder = path === "-" ? realPath(".") : dirname(realPath(path));
    this.#header = { sim3align: version, ...header((file) => this.#relative(absolutePath(file))) };
    if (ordinary) this.#lock = lockRecord("--jsonl", path);
    if (ordinary && !isResumed && sizeOf(path) > 0) {
      throw new UsageError(`--jsonl ${path}: the file has content. Pass --resume to go on, or remove the file.`);
    }
    this.#file = new OutputFile(path, true);
  }

  #relative(path: string): string {
    return relative(this.#folder, path).split(sep).join("/") || ".";
  }

  /** Adds a case that the file does not hold yet. */
  add(task: CaseKey, entry: Entry): void {
    const { name, path, folder } = task;
    if (this.#keys.has(keyOf(task))) return;
    this.#lock?.check();
    const content = folder === undefined ? undefined : contentHash(folder);
    const recorded = path === undefined ? undefined : this.#relative(path);
    const line = JSON.stringify({ case: name, path: recorded, content, ...entry });
    this.#file.lines(this.#isBegun ? [line] : [JSON.stringify(this.#header), line]);
    this.#isBegun = true;
  }

  end(): void {
    this.#file.end();
    this.#lock?.release();
  }

  /**
   * The entries in the file, each case once. A last line that was not written to its end is removed.
   * @throws {@link UsageError} for a file with other content, which stays as it is
   */
  async *#entries(): AsyncGenerator<RecordedEntry, void, undefined> {
    const size = sizeOf(this.path);
    if (size === 0) return;
    const isCutOff = bytesOf(this.path, size - 1, 1)[0] !== NEWLINE;
    const seen = new Set<string>();
    let number = 0;
    // A character of Latin-1 is a byte: the last line may end within a longer one.
    const bytes = createReadStream(this.path, { encoding: "latin1", end: size - 1 });
    for await (const { line, isLast } of withLast(createInterface({ input: bytes, crlfDelay: Infinity }))) {
      number += 1;
      if (line.trim() === "") continue;
      const isTorn = isCutOff && isLast;
      const found = parsed(line);
      if (found === undefined && isTorn && STARTS.some((start) => line.startsWith(start.slice(0, line.length)))) {
        truncateSync(this.path, size - line.length);
        return;
      }
      // Records that were joined have several such lines.
      if (number === 1 || found?.sim3align !== undefined) this.#checkHeader(found ?? {});
      else if (typeof found?.case !== "string") throw this.#foreign(number);
      // Only the line break is missing.
      if (isTorn) appendFileSync(this.path, "\n");
      this.#isBegun = true;
      if (found?.sim3align !== undefined) continue;
      const entry = this.#entry(found as Entry);
      const key = keyOf(entry);
      if (!seen.has(key)) yield entry;
      seen.add(key);
    }
  }

  /** @throws {@link UsageError} for a record of other settings */
  #checkHeader(found: Entry): void {
    const wayOut = "Pass another file, or remove this one.";
    if (found.sim3align === undefined) {
      const expected = "line 1 does not have the version, the command and the options that it was made with";
      throw new UsageError(`--jsonl ${this.path}: ${expected}. ${wayOut}`);
    }
    const flat = ({ sim3align, command, options }: Entry) => ({
      ...{ version: sim3align, command },
      ...Object.fromEntries(Object.entries(isRecord(options) ? options : {}).map(([name, to]) => [`--${name}`, to])),
    });
    const [before, now] = [flat(found), flat(JSON.parse(JSON.stringify(this.#header)))] as [Entry, Entry];
    const names = [...new Set([...Object.keys(before), ...Object.keys(now)])];
    const differing = names.filter((name) => !isDeepStrictEqual(before[name], now[name]));
    if (differing.length === 0) return;
    const shown = (value: unknown) => (value === undefined ? "nothing" : JSON.stringify(value));
    const list = differing.map((name) => `${name} is ${shown(now[name])}, was ${shown(before[name])}`).join("; ");
    throw new UsageError(`--jsonl ${this.path}: the record was made with other settings: ${list}. ${wayOut}`);
  }

  /** The entries in the file, each with its case. The file is read twice, and not kept. */
  async *resumed<T extends CaseKey>(tasks: readonly T[]): AsyncGenerator<Resumed<T>, void, undefined> {
    const byKey = new Map(tasks.map((task) => [keyOf(task), task]));
    const moved = await this.#moved(byKey);
    const names = new Set(tasks.map(({ name }) => name));
    for await (const recorded of this.#entries()) {
      const key = keyOf(recorded);
      const task = byKey.get(key) ?? moved.get(key);
      const { name, entry } = recorded;
      if (task !== undefined) this.#keys.add(keyOf(task));
      // Another batch may have called another case so.
      yield { task, entry, name: task?.name ?? (names.has(name) ? key : name) };
    }
  }

  /** The cases that have moved, by the keys of their entries: nothing is at the recorded path, and the content is the same. */
  async #moved<T extends CaseKey>(byKey: ReadonlyMap<string, T>): Promise<Map<string, T>> {
    const left = new Map(byKey);
    const lost = new Map<string, string[]>();
    for await (const recorded of this.#entries()) {
      const { path, content } = recorded;
      if (left.delete(keyOf(recorded)) || path === undefined || content === undefined || existsSync(path)) continue;
      lost.set(content, [...(lost.get(content) ?? []), keyOf(recorded)]);
    }
    const moved = new Map<string, T>();
    for (const task of lost.size === 0 ? [] : left.values()) {
      const content = task.folder === undefined ? undefined : contentHash(task.folder);
      const key = content === undefined ? undefined : lost.get(content)?.shift();
      if (key !== undefined) moved.set(key, task);
    }
    return moved;
  }

  #foreign(line: number): UsageError {
    const expected = 'an object with "case", as --jsonl writes them';
    return new UsageError(
      `--jsonl ${this.path}: line ${line} is not ${expected}. Remove the line, or pass another file.`,
    );
  }

  #entry({ case: name, path, content, ...entry }: Entry): RecordedEntry {
    return {
      name: String(name),
      path: typeof path === "string" ? join(this.#folder, path) : undefined,
      content: typeof content === "string" ? content : undefined,
      entry,
    };
  }
}

/** The object in a line of bytes. */
function parsed(line: string): Entry | undefined {
  try {
    const json: unknown = JSON.parse(Buffer.from(line, "latin1").toString());
    return isRecord(json) ? json : undefined;
  } catch {
    return undefined;
  }
}

const sizeOf = (path: string) => statOf(path)?.size ?? 0;

/** Lines, and whether each is the last one. */
async function* withLast(lines: AsyncIterable<string>) {
  let line: string | undefined;
  for await (const next of lines) {
    if (line !== undefined) yield { line, isLast: false };
    line = next;
  }
  if (line !== undefined) yield { line, isLast: true };
}
