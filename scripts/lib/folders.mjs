/** Folders that the user names: each itself, or those in it. */
import { readdirSync } from "node:fs";
import { join, resolve } from "node:path";

/**
 * The folders of a kind among folders and their subfolders, in the order of their names.
 * @param {readonly string[]} folders
 * @param {(folder: string) => boolean} isOfKind
 */
export const foldersOf = (folders, isOfKind) =>
  folders
    .map((folder) => resolve(folder))
    .flatMap((folder) =>
      isOfKind(folder)
        ? folder
        : readdirSync(folder)
            .sort()
            .map((name) => join(folder, name))
            .filter(isOfKind),
    );
