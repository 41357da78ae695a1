/** The record of a batch, from which it can be resumed: a line of JSON for each case. */
import { createHash } from "node:crypto";
import {
  appendFileSync,
  createReadStream,
  existsSync,
  readFileSync,
  realpathSync,
  statSync,
  truncateSync,
} from "node:fs";
import { basename, dirname, join, relative, resolve, sep } from "node:path";
import { createInterface } from "node:readline";
import { caseFiles } from "../case-files.js";
import type { Entry } from "./entry.js";
import { bytesOf, isOrdinary, namesIn, OutputFile, UsageError } from "./files.js";
import { lockRecord } from "./record-lock.js";

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

/** The absolute path of a case. A link to a folder is a case of its own; links above it are followed. */
export function absolutePath(path: string): string {
  const absolute = resolve(path);
  return join(realPath(dirname(absolute)), basename(absolute));
}

function realPath(path: string): string {
  try {
    return realpathSync(path);
  } catch {
    // It does not exist, which is reported for its case.
    return path;
  }
}

const inputs = new Set<string>([...Object.values(caseFiles).flat(), "pose.json"]);

/** A checksum of the inputs in a folder: its files, those of its frames and of its objects. `undefined` without files. */
function contentHash(folder: string): string | undefined {
  const hash = createHash("sha256");
  let isEmpty = true;
  const below = (path: string, pattern: RegExp) =>
    namesIn(path).flatMap((name) => (pattern.test(name) ? [join(path, name)] : []));
  for (const part of [folder, ...below(folder, /^frame_/), ...below(join(folder, "objects"), /./)]) {
    for (const name of namesIn(part)) {
      const path = join(part, name);
      try {
        if (!inputs.has(name) || !statSync(path).isFile()) continue;
        const bytes = readFileSync(path);
        hash.update(`${relative(folder, part).split(sep).join("/")}/${name} ${bytes.length}\n`).update(bytes);
        isEmpty = false;
      } catch {
        // What cannot be read is reported for the case.
      }
    }
  }
  return isEmpty ? undefined : hash.digest("hex").slice(0, 32);
}

/** The first bytes of every line. */
const START = '{"case":';
const NEWLINE = 0x0a;

/**
 * A line for each case: its entry, preceded by `case`, its name, `path`, its path relative to the record, and `content`, a
 * checksum of its inputs.
 */
export class JsonlFile {
  /** The folder to which paths are relative; that of stdout is the current one. */
  readonly #folder: string;
  readonly #file: OutputFile;
  readonly #release: () => void = () => {};

  /**
   * @param isResumed whether the lines of the file are kept
   * @throws {@link UsageError} if another process writes the file, or if it holds lines that are not to be kept
   */
  constructor(
    private readonly path: string,
    isResumed: boolean,
  ) {
    const isFile = isOrdinary(path);
    if (isResumed && !isFile) throw new UsageError(`--resume needs a file: --jsonl ${path} is none.`);
    if (isFile) this.#release = lockRecord("--jsonl", path);
    if (isFile && !isResumed && sizeOf(path) > 0) {
      throw new UsageError(`--jsonl ${path}: the file has content. Pass --resume to go on, or remove the file.`);
    }
    this.#folder = realPath(path === "-" ? process.cwd() : dirname(resolve(path)));
    this.#file = new OutputFile(path, "a");
  }

  add({ name, path, folder }: CaseKey, entry: Entry): void {
    const recorded = path === undefined ? undefined : relative(this.#folder, path).split(sep).join("/") || ".";
    const content = folder === undefined ? undefined : contentHash(folder);
    this.#file.lines([JSON.stringify({ case: name, path: recorded, content, ...entry })]);
  }

  end(): void {
    this.#file.end();
    this.#release();
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
      const found = this.#parsed(line);
      const isTorn = isCutOff && isLast;
      if (found === undefined && isTorn && line.startsWith(START.slice(0, line.length))) {
        truncateSync(this.path, size - line.length);
        return;
      }
      if (found === undefined) throw this.#foreign(number);
      // Only the line break is missing.
      if (isTorn) appendFileSync(this.path, "\n");
      const key = keyOf(found);
      if (!seen.has(key)) yield found;
      seen.add(key);
    }
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

  #parsed(line: string): RecordedEntry | undefined {
    try {
      const { case: name, path, content, ...entry } = JSON.parse(Buffer.from(line, "latin1").toString());
      if (typeof name !== "string") return undefined;
      return {
        name,
        path: typeof path === "string" ? join(this.#folder, path) : undefined,
        content: typeof content === "string" ? content : undefined,
        entry,
      };
    } catch {
      return undefined;
    }
  }
}

const sizeOf = (path: string) => statSync(path, { throwIfNoEntry: false })?.size ?? 0;

/** Lines, and whether each is the last one. */
async function* withLast(lines: AsyncIterable<string>) {
  let line: string | undefined;
  for await (const next of lines) {
    if (line !== undefined) yield { line, isLast: false };
    line = next;
  }
  if (line !== undefined) yield { line, isLast: true };
}
