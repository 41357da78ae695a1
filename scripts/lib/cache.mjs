/** Work that is not repeated: within a process, and between runs while its inputs stay the same. */
import { createHash } from "node:crypto";
import { existsSync, mkdirSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { dirname, join, relative, resolve } from "node:path";
import { repository } from "./paths.mjs";

/**
 * An action that runs once in this process, however often it is called.
 * @template T
 * @param {() => Promise<T>} action
 * @returns {() => Promise<T>}
 */
export function once(action) {
  /** @type {Promise<T> | undefined} */
  let result;
  return () => {
    result ??= action();
    return result;
  };
}

/**
 * All files below the given files and folders, in the same order everywhere; missing ones are left out.
 * @param {readonly string[]} paths
 * @returns {string[]}
 */
export function filesBelow(paths) {
  return paths.flatMap((path) => {
    if (!existsSync(path)) return [];
    if (!statSync(path).isDirectory()) return [path];
    const names = readdirSync(path).sort();
    return filesBelow(names.map((name) => join(path, name)));
  });
}

/**
 * The folders of a kind among folders and their subfolders, in the order of their names.
 * @param {readonly string[]} folders
 * @param {(folder: string) => boolean} isOfKind
 */
export const foldersOf = (folders, isOfKind) =>
  folders.flatMap((name) => {
    const folder = resolve(name);
    const inside = () =>
      readdirSync(folder)
        .sort()
        .map((each) => join(folder, each));
    return isOfKind(folder) ? [folder] : inside().filter(isOfKind);
  });

/**
 * A digest of files (names and contents) and of facts such as versions.
 * @param {readonly string[]} paths files and folders
 * @param {readonly string[]} [facts]
 */
export function digest(paths, facts = []) {
  const hash = createHash("sha256");
  for (const fact of facts) hash.update(`fact ${fact}\n`);
  for (const file of filesBelow(paths)) {
    const content = readFileSync(file);
    hash.update(`file ${relative(repository, file)} ${content.length}\n`).update(content);
  }
  return hash.digest("hex");
}

/**
 * Runs an action unless it succeeded before with the same inputs and its outputs are still there.
 * @param {string} stamp the file that keeps the digest of the last success
 * @param {string} inputs the digest of the present inputs
 * @param {readonly string[]} outputs files
 * @param {() => Promise<void> | void} action
 * @returns {Promise<boolean>} whether it ran
 */
export async function cached(stamp, inputs, outputs, action) {
  const isCurrent = existsSync(stamp) && readFileSync(stamp, "utf8") === inputs;
  if (isCurrent && outputs.every((output) => existsSync(output))) return false;
  rmSync(stamp, { force: true });
  await action();
  mkdirSync(dirname(stamp), { recursive: true });
  writeFileSync(stamp, inputs);
  return true;
}
