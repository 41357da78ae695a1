/** The cases of a command line. */
import { readFileSync } from "node:fs";
import { basename, join } from "node:path";
import { type CaseOnDisk, type CasePaths, type CaseSettings, readCaseFiles, readCaseFolder } from "../case-folder.js";
import { parsePoseFile } from "../conventions/pose-file.js";
import { absolutePath } from "./case-identity.js";
import type { FolderToDo } from "./folders.js";
import type { CaseKey } from "./jsonl-file.js";
import { UsageError } from "./usage-error.js";

/** A case to read and align. */
export interface CaseToDo extends CaseKey {
  /** Whether its true pose is known. */
  hasTruth: boolean;
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

/** The case of the files that the flags name; `undefined` if they name none. */
export function caseOfFiles(flags: FileFlags, hasFolders: boolean, settings: CaseSettings): CaseToDo | undefined {
  const { depth, mask, mesh, camera } = flags;
  const image = typeof flags.image === "string" ? flags.image : undefined;
  const given = [depth, mask, mesh, camera].filter((flag) => flag !== undefined).length;
  if (given === 0 && image !== undefined)
    throw new UsageError("--image belongs to --depth, --mask, --mesh and --camera; a case folder holds its own.");
  if (given === 0 && !hasFolders)
    throw new UsageError("Pass at least one case folder, or --depth, --mask, --mesh and --camera.");
  if (given === 0) return undefined;
  if (hasFolders) throw new UsageError("Pass case folders, or --depth, --mask, --mesh and --camera, but not both.");
  if (depth === undefined || mask === undefined || mesh === undefined || camera === undefined) {
    throw new UsageError("--depth, --mask, --mesh and --camera belong together: pass all four.");
  }
  const name = basename(mesh).replace(/\.[^.]*$/, "");
  const read = () => readCaseFiles(name, { depth, mask, mesh, camera, image }, settings);
  // Of the files, the mask is that of one object in one image.
  return { name, path: absolutePath(mask), hasTruth: false, read };
}

/** Cases in folders. */
export const casesIn = (folders: readonly FolderToDo[], settings: CaseSettings): CaseToDo[] =>
  folders.map((each) => ({
    ...each,
    // Read when it is asked for: among thousands of cases, the first ones tell.
    get hasTruth() {
      return hasTruth(each.folder);
    },
    read: () => readCaseFolder(each.folder, settings),
  }));

function hasTruth(folder: string): boolean {
  try {
    return parsePoseFile("truth", readFileSync(join(folder, "gt.json"))) !== null;
  } catch {
    // A file that cannot be read is reported for its case.
    return false;
  }
}
