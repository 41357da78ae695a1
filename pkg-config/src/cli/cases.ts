/** The cases of a command line. */
import { readFileSync, statSync } from "node:fs";
import { basename, join } from "node:path";
import {
  type CaseOnDisk,
  type CasePaths,
  type ReadCaseOptions,
  readCaseFiles,
  readCaseFolder,
} from "../case-folder.js";
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

/**
 * The case of the files that the flags name; `undefined` if they name none.
 * @param args the arguments beside the flags; a photo belongs to the files
 */
export function caseOfFiles(
  flags: FileFlags,
  args: readonly string[],
  hasList: boolean,
  settings: ReadCaseOptions,
): CaseToDo | undefined {
  const { depth, mask, mesh, camera } = flags;
  const photos = args.filter(isPhoto);
  const named = typeof flags.image === "string" ? [flags.image, ...photos] : photos;
  const given = [depth, mask, mesh, camera].filter((flag) => flag !== undefined).length;
  if (given === 0) {
    if (typeof flags.image === "string")
      throw new UsageError("--image belongs to --depth, --mask and --mesh; a case folder holds its own.");
    if (photos.length > 0 && photos.length === args.length && !hasList)
      throw new UsageError(`${photos[0]} is a photo: pass its --depth, --mask and --mesh with it.`);
    if (args.length === 0 && !hasList)
      throw new UsageError("Pass at least one case folder, or --depth, --mask and --mesh.");
    return undefined;
  }
  if (hasList || photos.length < args.length)
    throw new UsageError("Pass case folders, or --depth, --mask and --mesh, but not both.");
  if (named.length > 1) throw new UsageError(`Pass one photo, not ${named.join(" and ")}.`);
  if (depth === undefined || mask === undefined || mesh === undefined) {
    throw new UsageError("--depth, --mask and --mesh belong together: pass all three.");
  }
  const [image] = named;
  const name = basename(mesh).replace(/\.[^.]*$/, "");
  const read = () => readCaseFiles(name, { depth, mask, mesh, camera, image }, settings);
  // Of the files, the mask is that of one object in one image.
  return { name, path: absolutePath(mask), hasTruth: false, read };
}

/** Whether an argument names a photo; folders may be named like one. */
const isPhoto = (path: string) =>
  /\.(jpe?g|png)$/i.test(path) && !statSync(path, { throwIfNoEntry: false })?.isDirectory();

/** Cases in folders. */
export const casesIn = (folders: readonly FolderToDo[], settings: ReadCaseOptions): CaseToDo[] =>
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
