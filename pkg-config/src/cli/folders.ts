/** Folders on the command line: paths, patterns and lists. */
import { existsSync } from "node:fs";
import { readFile } from "node:fs/promises";
import { basename, join, resolve } from "node:path";
import { text } from "node:stream/consumers";
import { isBopScene } from "../bop/dataset.js";
import { partOf } from "../case-names.js";
import { isView } from "../scene/sam3d-files.js";
import { absolutePath, isFile, namesIn, UsageError } from "./files.js";
import { isPattern, matchingFolders } from "./pattern.js";
import type { CaseKey } from "./record.js";
import { note } from "./terminal.js";

/** A kind of folders. */
export interface FolderKind {
  /** The name of one folder. */
  noun: string;
  /** The mark of such a folder, for errors. */
  mark: string;
  /** The command that takes it. */
  command: string;
  /** Whether a folder is one. */
  is(folder: string): boolean;
}

/** Whether a folder with these entries has the layout of FoundationPose. */
const isFoundationPose = (names: readonly string[]) => names.includes("mesh") && names.includes("depth");

const hasMesh = (folder: string) => {
  const names = namesIn(folder);
  return names.some((name) => partOf(name) === "mesh") || isFoundationPose(names);
};

const hasFrames = (folder: string) => {
  const names = namesIn(folder);
  return isFoundationPose(names) || names.some((name) => name.startsWith("frame_"));
};

export const caseKind: FolderKind = { noun: "case", mark: "a mesh", command: "align", is: hasMesh };
export const videoKind: FolderKind = { noun: "video", mark: "a mesh", command: "track", is: hasMesh };
const hasObjects = (names: readonly string[]) => names.includes("objects") || isBopScene(names);
export const sceneKind: FolderKind = {
  noun: "scene",
  mark: "objects",
  command: "scene",
  is: (folder) => hasObjects(namesIn(folder)),
};
const hasView = (folder: string) => namesIn(folder).some(isView);
export const sam3dKind: FolderKind = {
  noun: "scene",
  mark: "a point map or depth",
  command: "scene --sam3d",
  is: hasView,
};

/** A folder to work on. */
export interface FolderToDo extends CaseKey {
  path: string;
  folder: string;
}

/**
 * The folders that the arguments and a list name, in order. They are named by their own names, or by their paths if names
 * repeat. Files, which `cases/*` may match, are skipped, and so are folders that were given before. Two links to one folder
 * are two folders.
 * @param list a file with a path per line; "-" is stdin
 * @throws {@link UsageError} for a pattern without match, for a list that cannot be read or is empty, for no folder at all,
 * and for a folder that only holds others
 */
export async function foldersToDo(
  kind: FolderKind,
  args: readonly string[],
  list: string | undefined,
): Promise<FolderToDo[]> {
  const paths = [
    ...args.flatMap((arg) => expanded(kind, arg)),
    ...(list === undefined ? [] : await listed(kind, list)),
  ];
  if (paths.length === 0) throw new UsageError(`Pass at least one ${kind.noun} folder.`);
  const files = paths.filter(isFile);
  const folders = unique(paths.filter((path) => !isFile(path)));
  if (folders.length === 0) throw new UsageError(`No ${kind.noun} folder among ${paths.join(", ")}.`);
  for (const { folder } of folders) refuseOther(kind, folder);
  if (files.length > 0) note(`skipped, not a folder: ${files.join(", ")}`);
  const nameOf = (folder: string) => basename(resolve(folder));
  const counts = new Map<string, number>();
  for (const { folder } of folders) counts.set(nameOf(folder), (counts.get(nameOf(folder)) ?? 0) + 1);
  return folders.map(({ folder, path }) => {
    const name = nameOf(folder);
    return { name: counts.get(name) === 1 ? name : folder, path, folder };
  });
}

/** The folders with their absolute paths, each path once. */
function unique(folders: readonly string[]): { folder: string; path: string }[] {
  const first = new Map<string, string>();
  const repeated: string[] = [];
  for (const folder of folders) {
    const path = absolutePath(folder);
    if (first.has(path)) repeated.push(folder);
    else first.set(path, folder);
  }
  if (repeated.length > 0) note(`skipped, given twice: ${repeated.join(", ")}`);
  return [...first].map(([path, folder]) => ({ folder, path }));
}

/** @throws {@link UsageError} for a folder of another kind, and one that is above of what is meant */
function refuseOther({ noun, is }: FolderKind, folder: string): void {
  if (is(folder)) return;
  const other = [sceneKind, caseKind].find((kind) => kind.noun !== noun && kind.is(folder));
  if (other !== undefined) {
    const isVideo = other === caseKind && hasFrames(folder);
    const track = isVideo ? `, or as a video to "sim3align ${videoKind.command}"` : "";
    throw new UsageError(
      `${folder} is a ${other.noun}, not a ${noun}: pass it to "sim3align ${other.command}"${track}.`,
    );
  }
  if (namesIn(folder).some((name) => partOf(name) !== undefined)) return;
  const inside = (path: string, depth: number): boolean =>
    namesIn(path).some((name) => is(join(path, name)) || (depth > 1 && inside(join(path, name), depth - 1)));
  if (!inside(folder, 2)) return;
  const pattern = `${folder.replace(/[\\/]+$/, "")}/**`;
  throw new UsageError(`${folder} is no ${noun} but holds some. Pass '${pattern}', in quotes, for all of them.`);
}

/** Expands a pattern that the shell did not expand. What exists is no pattern. */
function expanded({ noun, mark, is }: FolderKind, arg: string): string[] {
  if (arg === "") throw new UsageError(`An empty argument is no ${noun} folder; "." is the current one.`);
  const pattern = process.platform === "win32" ? arg.replaceAll("\\", "/") : arg;
  if (!isPattern(pattern) || existsSync(arg)) return [arg];
  const { folders, unread } = matchingFolders(pattern);
  if (unread.length > 0) note(`skipped, cannot be read: ${unread.join(", ")}`);
  // Of folders at any depth, most are above or inside of those that are meant.
  const meant = pattern.includes("**") ? folders.filter(is) : folders;
  if (meant.length > 0) return meant;
  throw new UsageError(`${arg}: no ${pattern.includes("**") ? `folder with ${mark}` : "folder"} matches the pattern.`);
}

/** Lines of the list; empty ones and comments are skipped. */
async function listed({ noun }: FolderKind, list: string): Promise<string[]> {
  const name = list === "-" ? "stdin" : list;
  const content = await (list === "-" ? text(process.stdin) : readFile(list, "utf8")).catch((error: Error) => {
    throw new UsageError(`--list ${list}: the list cannot be read: ${error.message}.`);
  });
  const paths = content
    .split("\n")
    .map((line) => line.trim())
    .filter((line) => line !== "" && !line.startsWith("#"));
  if (paths.length === 0) throw new UsageError(`--list: ${name} names no ${noun} folder; write one path per line.`);
  return paths;
}
