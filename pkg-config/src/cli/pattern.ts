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
  const all = alternatives([pattern]);
  if (all === undefined) throw new UsageError(`${pattern}: its braces stand for more than ${MOST} patterns.`);
  const folders = all.flatMap((each) => {
    const root = each.startsWith("/") ? "/" : "";
    const parts = each.split("/").filter((part) => part !== "" && part !== ".");
    // Several "**" in a row find the same folders as one, many times.
    const once = parts.filter((part, i) => part !== "**" || parts[i - 1] !== "**");
    return [...matches(root, once, unread)];
  });
  return { folders: [...new Set(folders)].sort(naturally), unread: [...unread] };
}

/** The most patterns that one with braces may stand for. */
const MOST = 10_000;

/** The patterns without braces that ones with braces stand for; `undefined` for too many. */
function alternatives(patterns: readonly string[]): readonly string[] | undefined {
  const opened = patterns.flatMap((pattern) => {
    const [all, choices] = /\{([^{}]*)\}/s.exec(pattern) ?? [];
    if (all === undefined || choices === undefined) return [pattern];
    const at = pattern.indexOf(all);
    const [before, after] = [pattern.slice(0, at), pattern.slice(at + all.length)];
    return choices.split(",").map((choice) => before + choice + after);
  });
  if (opened.length > MOST) return undefined;
  const isDone = opened.every((pattern, i) => pattern === patterns[i]);
  return isDone && opened.length === patterns.length ? opened : alternatives(opened);
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
    const tokens = tokensOf(part);
    for (const name of foldersIn(folder, unread)) {
      const isHidden = name.startsWith(".") && !part.startsWith(".");
      if (!isHidden && fits(tokens, [...name])) yield* matches(join(folder, name), more, unread);
    }
  }
}

/** The set of characters at a place of a pattern; `null` for any number of any characters. */
type Token = RegExp | null;

/** The tokens of a part of a pattern. A name may hold any character, also a line break. */
function tokensOf(part: string): Token[] {
  const tokens = part.matchAll(/\[([!^]?)(.+?)\]|./gsu);
  return Array.from(tokens, ([character, not = "", characters]) => {
    if (character === "*") return null;
    if (character === "?") return /./su;
    const [sign, list] = characters === undefined ? ["", character] : [not, characters];
    try {
      return new RegExp(`[${sign === "" ? "" : "^"}${list.replace(/[\\\]^[]/g, "\\$&")}]`, "u");
    } catch {
      throw new UsageError(`${part}: not a pattern. Write ranges in ascending order, such as [a-z].`);
    }
  });
}

/** Whether characters fit tokens: after a mismatch, the last star takes one character more. */
function fits(tokens: readonly Token[], characters: readonly string[]): boolean {
  let [token, star, from] = [0, -1, 0];
  let at = 0;
  while (at < characters.length) {
    const next = tokens[token];
    if (next === null) {
      [star, from] = [token, at];
      token += 1;
    } else if (next?.test(characters[at] as string)) {
      token += 1;
      at += 1;
    } else if (star >= 0) {
      from += 1;
      [token, at] = [star + 1, from];
    } else return false;
  }
  return tokens.slice(token).every((rest) => rest === null);
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
