/** The cases of a command line. */
import { readFileSync, realpathSync, statSync } from "node:fs";
import { basename, join, resolve } from "node:path";
import { type CaseOnDisk, type CasePaths, type CaseSettings, readCaseFiles, readCaseFolder } from "../case-folder.js";
import { parsePoseFile } from "../conventions/pose-file.js";
import { UsageError } from "./usage-error.js";

/** A case to read and align. */
export interface CaseToDo {
  name: string;
  /** Whether its true pose is known. */
  hasTruth: boolean;
  /** The folder, where the case is one. */
  folder?: string;
  read(): Promise<CaseOnDisk>;
}

/** The flags that name the files of a case. */
export interface FileFlags {
  depth?: string;
  mask?: string;
  mesh?: string;
  camera?: CasePaths["camera"];
  /** The photo, or whether to use that of a case folder. */
  image?: string | boolean;
}

/**
 * The cases of these folders, or of these files.
 * @throws {@link UsageError}
 */
export function casesOf(folders: readonly string[], flags: FileFlags, settings: CaseSettings): CaseToDo[] {
  const { depth, mask, mesh, camera } = flags;
  const image = typeof flags.image === "string" ? flags.image : undefined;
  const given = [depth, mask, mesh, camera].filter((flag) => flag !== undefined).length;
  if (given === 0 && image !== undefined)
    throw new UsageError("--image belongs to --depth, --mask, --mesh and --camera; a case folder holds its own.");
  if (given === 0 && folders.length === 0)
    throw new UsageError("Pass at least one case folder, or --depth, --mask, --mesh and --camera.");
  if (given === 0) return casesIn(folders, settings);
  if (folders.length > 0)
    throw new UsageError("Pass case folders, or --depth, --mask, --mesh and --camera, but not both.");
  if (depth === undefined || mask === undefined || mesh === undefined || camera === undefined) {
    throw new UsageError("--depth, --mask, --mesh and --camera belong together: pass all four.");
  }
  const name = basename(mesh).replace(/\.[^.]*$/, "");
  return [{ name, hasTruth: false, read: () => readCaseFiles(name, { depth, mask, mesh, camera, image }, settings) }];
}

/**
 * Cases are named by their folders, or by their paths if names repeat. Files, which `cases/*` may match, are skipped,
 * and so are folders that were given before.
 */
function casesIn(paths: readonly string[], settings: CaseSettings): CaseToDo[] {
  const isFile = (path: string) => statSync(path, { throwIfNoEntry: false })?.isFile() === true;
  const folders = unique(paths.filter((path) => !isFile(path)));
  if (folders.length === 0) throw new UsageError(`No case folder among ${paths.join(", ")}.`);
  const files = paths.filter(isFile);
  if (files.length > 0) console.error(`skipped, not a folder: ${files.join(", ")}`);
  const counts = new Map<string, number>();
  const nameOf = (folder: string) => basename(resolve(folder));
  for (const folder of folders) counts.set(nameOf(folder), (counts.get(nameOf(folder)) ?? 0) + 1);
  return folders.map((folder) => {
    const name = nameOf(folder);
    return {
      name: counts.get(name) === 1 ? name : folder,
      // Read when it is asked for: among thousands of cases, the first ones tell.
      get hasTruth() {
        return hasTruth(folder);
      },
      folder,
      read: () => readCaseFolder(folder, settings),
    };
  });
}

/** The first path of each folder. */
function unique(paths: readonly string[]): string[] {
  const seen = new Set<string>();
  const repeated: string[] = [];
  const first = paths.filter((path) => {
    const real = realPath(path);
    const isFirst = !seen.has(real);
    if (!isFirst) repeated.push(path);
    seen.add(real);
    return isFirst;
  });
  if (repeated.length > 0) console.error(`skipped, given twice: ${repeated.join(", ")}`);
  return first;
}

function realPath(path: string): string {
  try {
    return realpathSync(path);
  } catch {
    // It does not exist, which is reported for its case.
    return resolve(path);
  }
}

function hasTruth(folder: string): boolean {
  try {
    return parsePoseFile("truth", readFileSync(join(folder, "gt.json"))) !== null;
  } catch {
    // A file that cannot be read is reported for its case.
    return false;
  }
}
