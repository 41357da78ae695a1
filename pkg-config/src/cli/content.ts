/** The content of a case: the files that its result was computed from, and their checksum. */
import { readFileSync } from "node:fs";
import { basename, join, relative, sep } from "node:path";
import { partOf } from "../case-names.js";
import { type Checksums, checksumOf } from "../read-files.js";
import { absolutePath, namesIn, partsOf, realPath } from "./files.js";

/** The checksums of the files of a case by their paths relative to a folder, and one of all of them. */
export interface Content {
  files: Readonly<Record<string, string>>;
  content: string;
}

/** The content of a case whose files were read; `undefined` if none was. */
export function contentOf(read: Checksums, folder: string): Content | undefined {
  const place = realPath(folder);
  const nameOf = (path: string) => relative(place, absolutePath(path)).split(sep).join("/");
  const files = [...read].map(([path, checksum]) => [nameOf(path), checksum] as const);
  return files.length === 0 ? undefined : total(files);
}

/** The content of these files as they are now; `undefined` if one of them is gone. */
export function contentNow(folder: string, files: readonly string[]): Content | undefined {
  try {
    return total(files.map((name) => [name, checksumOf(readFileSync(join(folder, name)))]));
  } catch {
    return undefined;
  }
}

/** The content of files. Its checksum depends neither on their order nor on a file that was read by two paths. */
function total(files: readonly (readonly [string, string])[]): Content {
  const sorted = [...new Map(files)].sort(([a], [b]) => (a < b ? -1 : 1));
  const lines = sorted.map(([name, checksum]) => `${name} ${checksum}\n`);
  return { files: Object.fromEntries(sorted), content: checksumOf(lines.join("")) };
}

/** The files of parts in the folder of a case, relative to it. */
export function partFiles(folder: string): string[] {
  const paths = partsOf(folder).flatMap((place) => namesIn(place).map((name) => join(place, name)));
  return paths
    .filter((path) => partOf(basename(path)) !== undefined)
    .map((path) => relative(folder, path).split(sep).join("/"));
}

/** The content of a case that failed: all its parts, though they were not read. */
export function contentOfFailure(folder: string): Content | undefined {
  const files = partFiles(folder);
  return files.length === 0 ? undefined : contentNow(folder, files);
}
