/** The content of a case: the files that its result was computed from, and their checksum. */
import { readFileSync } from "node:fs";
import { basename, join, relative, sep } from "node:path";
import { partOf } from "../case-names.js";
import { type Checksums, checksumOf } from "../read-files.js";
import { absolutePath, namesIn, partsOf, realPath } from "./files.js";

/** The files of a case, relative to a folder, and a checksum of their names and bytes. */
export interface Content {
  files: readonly string[];
  content: string;
}

/** The content of a case whose files were read; `undefined` if none was. */
export function contentOf(read: Checksums, folder: string): Content | undefined {
  const files = new Map<string, string>();
  const place = realPath(folder);
  for (const [path, checksum] of read) {
    const name = relative(place, absolutePath(path)).split(sep).join("/");
    // A true pose only measures errors.
    if (partOf(basename(path)) !== "truth") files.set(name, checksum);
  }
  const names = [...files.keys()].sort();
  return names.length === 0
    ? undefined
    : { files: names, content: total(names.map((name) => [name, files.get(name)])) };
}

/** The checksum of these files as they are now; `undefined` if one of them is gone. */
export function contentNow(folder: string, files: readonly string[]): string | undefined {
  try {
    return total(files.map((name) => [name, checksumOf(readFileSync(join(folder, name)))]));
  } catch {
    return undefined;
  }
}

const total = (files: readonly (readonly [string, string | undefined])[]) =>
  checksumOf(files.map(([name, checksum]) => `${name} ${checksum}\n`).join(""));

/** The files of parts in the folder of a case, but that of a true pose; relative to it. */
export function partFiles(folder: string): string[] {
  const paths = partsOf(folder).flatMap((place) => namesIn(place).map((name) => join(place, name)));
  return paths
    .filter((path) => ![undefined, "truth"].includes(partOf(basename(path))))
    .map((path) => relative(folder, path).split(sep).join("/"));
}

/** The content of a case that failed: all its parts, though they were not read. */
export function contentOfFailure(folder: string): Content | undefined {
  const files = partFiles(folder).sort();
  const content = contentNow(folder, files);
  return files.length === 0 || content === undefined ? undefined : { files, content };
}
