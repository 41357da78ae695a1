/** Paths and files on the command line. */
import { closeSync, openSync, readdirSync, readFileSync, readSync, realpathSync, type Stats, statSync } from "node:fs";
import { basename, dirname, join, resolve } from "node:path";
import { naturally } from "../values/order.js";

/** An invalid command line, which ends the program. */
export class UsageError extends Error {}

/** The names in a folder; none if it cannot be read. */
export function namesIn(folder: string): string[] {
  try {
    return readdirSync(folder).sort(naturally);
  } catch {
    return [];
  }
}

/** The folders that hold the files of a case or a scene: its own, and those of its frames and of its objects. */
export function partsOf(folder: string): string[] {
  const below = (path: string, pattern: RegExp) =>
    namesIn(path).flatMap((name) => (pattern.test(name) ? [join(path, name)] : []));
  return [folder, ...below(folder, /^frame_/), ...below(join(folder, "objects"), /./)];
}

/**
 * The text of the file that a flag names.
 * @throws {@link UsageError} if it cannot be read
 */
export function textOf(flag: string, path: string): string {
  try {
    if (!isOrdinary(path)) throw new Error("it is no ordinary file");
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

/** The file status of a path; `undefined` if the path does not exist or cannot exist. */
export function statOf(path: string): Stats | undefined {
  try {
    return statSync(path);
  } catch {
    return undefined;
  }
}

/** Whether a path is an ordinary file. */
export const isFile = (path: string) => statOf(path)?.isFile() === true;

/** Whether a path is, or will be, an ordinary file; not stdout ("-"), a pipe or a device. */
export const isOrdinary = (path: string) => path !== "-" && statOf(path)?.isFile() !== false;

/** The absolute path without links; of what does not exist, as much of it as does. */
export function realPath(path: string): string {
  try {
    return realpathSync.native(path);
  } catch {
    const folder = dirname(path);
    return folder === path ? resolve(path) : join(realPath(folder), basename(path));
  }
}

/** The absolute path of a case. A link to a folder is a case of its own; links above it are followed. */
export function absolutePath(path: string): string {
  const absolute = resolve(path);
  return join(realPath(dirname(absolute)), basename(absolute));
}

/** The identity of a file, which all its names share, links and those in other case; `undefined` without a file. */
export function identityOf(path: string): string | undefined {
  try {
    const { dev, ino } = statSync(path, { bigint: true });
    return `${dev}:${ino}`;
  } catch {
    return undefined;
  }
}

/** The absolute path of a file and, if it exists, its identity. */
export function placesOf(path: string): string[] {
  if (path === "-") return [path];
  const place = realPath(path);
  const identity = identityOf(place);
  return [place, ...(identity === undefined ? [] : [identity])];
}
