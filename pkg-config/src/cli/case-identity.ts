/** What a case is in a record: its path relative to the record, and its content for where it has moved. */
import { createHash } from "node:crypto";
import { readdirSync, readFileSync, realpathSync, statSync } from "node:fs";
import { basename, dirname, join, relative, resolve, sep } from "node:path";
import { caseFiles } from "../case-files.js";

/** The absolute path of a case. A link to a folder is a case of its own; links above it are followed. */
export function absolutePath(path: string): string {
  const absolute = resolve(path);
  return join(realPath(dirname(absolute)), basename(absolute));
}

/** The path of a case relative to the folder of a record, with slashes; "-" is stdout, in the current folder. */
export function recordedPath(record: string, path: string): string {
  return relative(folderOf(record), path).split(sep).join("/") || ".";
}

/** The absolute path of a case in a record. */
export const pathIn = (record: string, recorded: string): string => join(folderOf(record), recorded);

const folderOf = (record: string) => realPath(record === "-" ? process.cwd() : dirname(resolve(record)));

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
export function contentHash(folder: string): string | undefined {
  const hash = createHash("sha256");
  let isEmpty = true;
  const add = (path: string, name: string) => {
    try {
      if (!statSync(join(path, name)).isFile()) return;
      const bytes = readFileSync(join(path, name));
      hash.update(`${relative(folder, path).split(sep).join("/")}/${name} ${bytes.length}\n`).update(bytes);
      isEmpty = false;
    } catch {
      // What cannot be read is reported for the case.
    }
  };
  const parts = [folder, ...childrenOf(folder, /^frame_/), ...childrenOf(join(folder, "objects"), /./)];
  for (const part of parts) for (const name of namesIn(part)) if (inputs.has(name)) add(part, name);
  return isEmpty ? undefined : hash.digest("hex").slice(0, 32);
}

const childrenOf = (folder: string, pattern: RegExp) =>
  namesIn(folder)
    .filter((name) => pattern.test(name))
    .map((name) => join(folder, name));

/** The names in a folder; none if it cannot be read. */
export function namesIn(folder: string): string[] {
  try {
    return readdirSync(folder).sort();
  } catch {
    return [];
  }
}
