/** The record of a batch, from which it can be resumed: a line with its settings, and a line of JSON for each case. */
import { appendFileSync, existsSync, readFileSync, truncateSync } from "node:fs";
import { basename, dirname, join, relative, sep } from "node:path";
import { isDeepStrictEqual } from "node:util";
import { partOf } from "../case-names.js";
import type { Checksums } from "../read-files.js";
import { isRecord } from "../values/kinds.js";
import { stringsIn } from "../values/validation.js";
import { type Content, contentNow, contentOf, contentOfFailure, partFiles } from "./content.js";
import { type Entry, isFailure } from "./entry.js";
import { absolutePath, isOrdinary, realPath, statOf, UsageError } from "./files.js";
import { linesIn } from "./lines.js";
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
  /** The absolute paths of its files, if it is no folder: with others, it is another case. */
  files?: readonly string[] | undefined;
}

/** The entry of a case in a record. */
interface RecordedEntry {
  name: string;
  /** Its absolute path. */
  path?: string | undefined;
  /** The files that it was computed from, and their checksum. */
  content?: Content | undefined;
  entry: Entry;
}

/** An entry of the record of a batch, with the case of the batch and the name of that case. */
export interface Resumed<T extends CaseKey> extends Pick<RecordedEntry, "name" | "path" | "entry"> {
  task: T | undefined;
}

const keyOf = ({ path, name }: Pick<CaseKey, "path" | "name">) => path ?? name;

/** The settings that the results of a record depend on beside the cases; `pathOf` returns the paths of files as the record has them. */
export type RecordHeader = (pathOf: (path: string) => string) => { command: string; options: Record<string, unknown> };

/** The first bytes of the lines of cases, and of the first line. */
const STARTS = ['{"case":', '{"sim3align":'];

/** Whether a text begins like a record. */
export const isRecordText = (text: string): boolean => STARTS.some((start) => text.startsWith(start));

/**
 * A line with `sim3align`, the version, `command` and `options`, and a line for each case: its entry, preceded by `case`, its
 * name, `path`, its path relative to the record, `files`, the checksums of those that it was computed from, by their paths relative
 * to the case or, of files, to the record, and `content`, the checksum of all. Of several lines of a case, the last one counts.
 */
export class JsonlFile {
  /** The folder to which paths are relative; that of stdout is the current one. */
  readonly #folder: string;
  readonly #relative: (path: string) => string;
  readonly #file: OutputFile;
  readonly #header: Readonly<Record<string, unknown>>;
  readonly #isWithoutPhotos: boolean;
  #isBegun = false;
  readonly #lock: RecordLock | undefined;
  /** The keys of the cases that are done. */
  readonly #done = new Set<string>();

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
    this.#folder = folderOf(path);
    this.#relative = relativeTo(path);
    const settings = header((file) => this.#relative(absolutePath(file)));
    this.#header = { sim3align: version, ...settings };
    this.#isWithoutPhotos = settings.options["no-image"] === true;
    if (ordinary) this.#lock = lockRecord("--jsonl", path);
    if (ordinary && !isResumed && sizeOf(path) > 0) {
      throw new UsageError(`--jsonl ${path}: the file has content. Pass --resume to go on, or remove the file.`);
    }
    this.#file = new OutputFile(path, true);
  }

  /** Adds a case that the file does not hold yet, with the checksums of the files that it was computed from. */
  add(task: CaseKey, entry: Entry, read: Checksums): void {
    const { name, path } = task;
    if (this.#done.has(keyOf(task))) return;
    this.#lock?.check();
    const recorded = path === undefined ? undefined : this.#relative(path);
    const { folder } = task;
    const failed = folder !== undefined && isFailure(entry) ? contentOfFailure(folder) : undefined;
    const content = failed ?? contentOf(read, folder ?? this.#folder);
    const line = JSON.stringify({ case: name, path: recorded, ...content, ...entry });
    this.#file.lines(this.#isBegun ? [line] : [JSON.stringify(this.#header), line]);
    this.#isBegun = true;
  }

  end(): void {
    this.#file.end();
    this.#lock?.release();
  }

  /**
   * The entries in the file. A last line that was not written to its end is removed.
   * @throws {@link UsageError} for a file with other content, which stays as it is
   */
  async *#entries(): AsyncGenerator<RecordedEntry, void, undefined> {
    if (sizeOf(this.path) === 0) return;
    const tooLong = (problem: string) => new UsageError(`--jsonl ${this.path}: ${problem}. Pass another file.`);
    for await (const { bytes, start, number, isEnded } of linesIn(this.path, tooLong)) {
      // The last line may end within a character.
      const line = bytes.toString();
      if (line.trim() === "") continue;
      const found = parsed(line);
      if (found === undefined && !isEnded && STARTS.some((known) => line.startsWith(known.slice(0, line.length)))) {
        truncateSync(this.path, start);
        return;
      }
      // Records that were joined have several such lines.
      if (number === 1 || found?.sim3align !== undefined) this.#checkHeader(found ?? {});
      else if (typeof found?.case !== "string") throw this.#foreign(number);
      // Only the line break is missing.
      if (!isEnded) appendFileSync(this.path, "\n");
      this.#isBegun = true;
      if (found?.sim3align !== undefined) continue;
      yield this.#entry(found as Entry);
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
    const shown = (value: unknown) => (value === undefined ? "not given" : JSON.stringify(value));
    const list = differing.map((name) => `${name} is ${shown(now[name])}, was ${shown(before[name])}`).join("; ");
    throw new UsageError(`--jsonl ${this.path}: the record was made with other settings: ${list}. ${wayOut}`);
  }

  /**
   * The entries in the file, each with its case, but those of cases whose files have changed since. The file is read twice, and
   * not kept.
   * @param changed is called with the cases that have changed
   */
  async *resumed<T extends CaseKey>(
    tasks: readonly T[],
    changed: (task: T) => void,
  ): AsyncGenerator<Resumed<T>, void, undefined> {
    const { last, moved } = await this.#index(tasks);
    const byKey = new Map(tasks.map((task) => [keyOf(task), task]));
    const names = new Set(tasks.map(({ name }) => name));
    let number = 0;
    for await (const recorded of this.#entries()) {
      number += 1;
      const { name, entry, content } = recorded;
      const key = rowKey(recorded, this.#folder);
      if (last.get(key) !== number) continue;
      const task = byKey.get(keyOf(recorded)) ?? moved.get(key);
      if (task !== undefined && !isSame(task, content, this.#folder)) continue;
      if (task !== undefined && this.#hasChanged(task, content, entry)) {
        changed(task);
        continue;
      }
      if (task !== undefined) this.#done.add(keyOf(task));
      // Another batch may have called another case so.
      const path = task?.path ?? recorded.path;
      yield { task, path, entry, name: task?.name ?? (names.has(name) ? keyOf(recorded) : name) };
    }
  }

  /**
   * The last line of each row, and the cases that have moved, by the keys of their rows: nothing is at the recorded path, and
   * the content is the same.
   */
  async #index<T extends CaseKey>(tasks: readonly T[]) {
    const left = new Map(tasks.map((task) => [keyOf(task), task]));
    const last = new Map<string, number>();
    const lost = new Map<string, Content>();
    let number = 0;
    for await (const recorded of this.#entries()) {
      number += 1;
      const { path, content } = recorded;
      const key = rowKey(recorded, this.#folder);
      last.set(key, number);
      if (!left.delete(keyOf(recorded)) && path !== undefined && content !== undefined && !existsSync(path)) {
        lost.set(key, content);
      }
    }
    const moved = new Map<string, T>();
    const rows = new LostRows(lost);
    for (const task of left.values()) {
      const key = task.folder === undefined ? undefined : rows.take(task.folder);
      if (key !== undefined) moved.set(key, task);
    }
    return { last, moved };
  }

  /** Whether files of a case have been changed or added since its row was written. */
  #hasChanged({ folder }: CaseKey, content: Content | undefined, { unread }: Entry): boolean {
    const files = Object.keys(content?.files ?? {});
    if (content !== undefined && contentNow(folder ?? this.#folder, files)?.content !== content.content) return true;
    const known = new Set([...files, ...stringsIn(unread)]);
    const isRead = (file: string) => !this.#isWithoutPhotos || partOf(basename(file)) !== "image";
    return folder !== undefined && partFiles(folder).some((file) => !known.has(file) && isRead(file));
  }

  #foreign(line: number): UsageError {
    const expected = 'an object with "case", as --jsonl writes them';
    return new UsageError(
      `--jsonl ${this.path}: line ${line} is not ${expected}. Remove the line, or pass another file.`,
    );
  }

  #entry({ case: name, path, files, content, ...entry }: Entry): RecordedEntry {
    return {
      name: String(name),
      path: typeof path === "string" ? join(this.#folder, path) : undefined,
      content:
        typeof content === "string" && isRecord(files) ? { content, files: files as Content["files"] } : undefined,
      entry,
    };
  }
}

/** Rows with nothing at their paths, by their files and the checksum of these: the files of a folder are read once for each list. */
class LostRows {
  readonly #lists = new Map<string, { files: readonly string[]; keys: Map<string, string[]> }>();

  constructor(rows: ReadonlyMap<string, Content>) {
    for (const [key, { files, content }] of rows) {
      const names = Object.keys(files);
      const list = names.join("\n");
      const { keys } = this.#lists.get(list) ?? { keys: new Map<string, string[]>() };
      this.#lists.set(list, { files: names, keys });
      keys.set(content, [...(keys.get(content) ?? []), key]);
    }
  }

  /** Removes the first row with the content of a folder, and returns its key. */
  take(folder: string): string | undefined {
    for (const { files, keys } of this.#lists.values()) {
      const key = keys.get(contentNow(folder, files)?.content ?? "")?.shift();
      if (key !== undefined) return key;
    }
    return undefined;
  }
}

/** The key of a row: cases of files are several of one path, that of the mask. */
function rowKey(recorded: RecordedEntry, folder: string): string {
  const files = Object.keys(recorded.content?.files ?? {});
  const isOfFiles = files.some((file) => join(folder, file) === recorded.path);
  return isOfFiles ? files.join("\n") : keyOf(recorded);
}

/** Whether a row is of the files of a case; any row, if this is a folder. */
function isSame({ files = [] }: CaseKey, content: Content | undefined, folder: string): boolean {
  const recorded = Object.keys(content?.files ?? {}).map((file) => join(folder, file));
  return files.every((file) => recorded.includes(file));
}

/** The object in a line. */
function parsed(line: string): Entry | undefined {
  try {
    const json: unknown = JSON.parse(line);
    return isRecord(json) ? json : undefined;
  } catch {
    return undefined;
  }
}

/** The folder to which the paths in an output are relative; that of stdout is the current one. */
const folderOf = (path: string) => (path === "-" ? realPath(".") : dirname(realPath(path)));

/** Makes the paths of cases relative to the folder of an output. */
export function relativeTo(output: string): (path: string) => string {
  const folder = folderOf(output);
  return (path) => relative(folder, path).split(sep).join("/") || ".";
}

const sizeOf = (path: string) => statOf(path)?.size ?? 0;
