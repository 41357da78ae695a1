/** Paths of case folders on the command line: folders, patterns and lists. */
import { existsSync } from "node:fs";
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { text } from "node:stream/consumers";
import { globSync, isDynamicPattern } from "tinyglobby";
import { caseFiles } from "../case-files.js";
import { UsageError } from "./usage-error.js";

/**
 * The paths that the arguments and a list name, in order.
 * @param list a file with a path per line; "-" is stdin
 * @throws {@link UsageError} for a pattern without match, and for a list that cannot be read or is empty
 */
export async function casePaths(args: readonly string[], list: string | undefined): Promise<string[]> {
  return [...args.flatMap(expanded), ...(list === undefined ? [] : await listed(list))];
}

/** Expands a pattern that the shell did not expand. What exists is no pattern. */
function expanded(arg: string): string[] {
  const pattern = process.platform === "win32" ? arg.replaceAll("\\", "/") : arg;
  if (!isDynamicPattern(pattern) || existsSync(arg)) return [arg];
  const found = globSync(pattern, { onlyDirectories: true, expandDirectories: false });
  const folders = found.map((path) => path.replace(/\/$/, "")).sort();
  // Of folders at any depth, most are not cases but above or inside of them.
  const cases = pattern.includes("**") ? folders.filter(hasMesh) : folders;
  if (cases.length > 0) return cases;
  throw new UsageError(`${arg}: no ${pattern.includes("**") ? "folder with a mesh" : "folder"} matches the pattern.`);
}

const hasMesh = (folder: string) => caseFiles.mesh.some((name) => existsSync(join(folder, name)));

/** Lines of the list; empty ones and comments are skipped. */
async function listed(list: string): Promise<string[]> {
  const name = list === "-" ? "stdin" : list;
  const content = await (list === "-" ? text(process.stdin) : readFile(list, "utf8")).catch((error: Error) => {
    throw new UsageError(`--list ${list}: the list cannot be read: ${error.message}.`);
  });
  const paths = content
    .split("\n")
    .map((line) => line.trim())
    .filter((line) => line !== "" && !line.startsWith("#"));
  if (paths.length === 0) throw new UsageError(`--list: ${name} names no case folder; write one path per line.`);
  return paths;
}
