/** Patterns of folders: `*` and `?` within a name, `[abc]`, `{a,b}`, and `**` for folders at any depth. */
import { type Dirent, existsSync, readdirSync, realpathSync, statSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { naturally } from "../values/order.js";
import { statOf, UsageError } from "./files.js";

/** Whether a path has characters of patterns. */
export const isPattern = (path: string): boolean => /[*?]|\[.+\]|\{.+\}/s.test(path);

/** The folders that match a pattern, sorted, and folders in which some may be that cannot be read. */
export function matchingFolders(pattern: string): { folders: string[]; unread: string[] } {
  const unread = new Set<string>();
  const folders = alternatives(pattern).flatMap((each) => {
    const root = each.startsWith("/") ? "/" : "";
    const parts = each.split("/").filter((part) => part !== "" && part !== ".");
    return [...matches(root, parts, unread)];
  });
  return { folders: [...new Set(folders)].sort(naturally), unread: [...unread] };
}

/** The patterns without braces that one with braces stands for. */
function alternatives(pattern: string): string[] {
  const [all, choices] = /\{([^{}]*)\}/s.exec(pattern) ?? [];
  if (all === undefined || choices === undefined) return [pattern];
  const at = pattern.indexOf(all);
  const [before, after] = [pattern.slice(0, at), pattern.slice(at + all.length)];
  return choices.split(",").flatMap((choice) => alternatives(before + choice + after));
}

/** @param folder the folder that the first parts of the pattern have led to; "" is the current one */
function* matches(folder: string, [part, ...more]: readonly string[], unread: Set<string>): Generator<string> {
  if (part === undefined) {
    yield folder === "" ? "." : folder;
  } else if (!isPattern(part)) {
    const path = join(folder, part);
    if (statOf(path)?.isDirectory()) yield* matches(path, more, unread);
  } else if (part === "**") {
    yield* matches(folder, more, unread);
    for (const name of foldersIn(folder, unread)) {
      if (!name.startsWith(".")) yield* matches(join(folder, name), [part, ...more], unread);
    }
  } else {
    const expression = expressionOf(part);
    for (const name of foldersIn(folder, unread)) {
      if (expression.test(name)) yield* matches(join(folder, name), more, unread);
    }
  }
}

/** A name may hold any character, also a line break. Those that begin with a dot only match a pattern that does. */
function expressionOf(part: string): RegExp {
  const source = part.replaceAll(/\[([!^]?)(.+?)\]|./gs, (character, not: string, characters?: string) => {
    if (character === "*") return "[^]*";
    if (character === "?") return "[^]";
    if (characters === undefined) return character.replace(/[\\^$.*+?()[\]{}|/]/, "\\$&");
    return `[${not === "" ? "" : "^"}${characters.replace(/[\\\]^[]/g, "\\$&")}]`;
  });
  try {
    return new RegExp(`^${part.startsWith(".") ? "" : "(?!\\.)"}${source}$`, "u");
  } catch {
    throw new UsageError(`${part}: not a pattern. Write ranges in ascending order, such as [a-z].`);
  }
}

/** The names of the folders in a folder; links are followed, but for those to a folder above, which have no end. */
function foldersIn(folder: string, unread: Set<string>): string[] {
  let entries: Dirent[];
  try {
    entries = readdirSync(folder === "" ? "." : folder, { withFileTypes: true });
  } catch (error) {
    unread.add(`${folder} (${(error as NodeJS.ErrnoException).code})`);
    return [];
  }
  return entries.flatMap((entry) => {
    if (!entry.isDirectory() && !entry.isSymbolicLink()) return [];
    const path = join(folder, entry.name);
    // Node replaces the bytes of a name that is no UTF-8.
    if (entry.name.includes("\ufffd") && !existsSync(path)) unread.add(`${path} (its name is no UTF-8)`);
    else if (entry.isDirectory() || isFolderBelow(path, folder)) return [entry.name];
    return [];
  });
}

function isFolderBelow(link: string, folder: string): boolean {
  try {
    if (!statSync(link).isDirectory()) return false;
    // By way of links, and without them.
    const above = [
      ...ancestry(resolve(folder)).map((path) => realpathSync(path)),
      ...ancestry(realpathSync(folder || ".")),
    ];
    return !above.includes(realpathSync(link));
  } catch {
    // A link to nothing.
    return false;
  }
}

/** A folder, and all folders above it. */
const ancestry = (path: string): string[] => (dirname(path) === path ? [path] : [path, ...ancestry(dirname(path))]);
