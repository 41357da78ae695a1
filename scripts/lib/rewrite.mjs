/** Committed files, parts of which follow from something else: brought up to date, or checked. */
import { readFileSync, writeFileSync } from "node:fs";
import { repository } from "./paths.mjs";

/**
 * The files that are out of date, with their new texts.
 * @param {readonly string[]} files
 * @param {(text: string) => string} updated
 */
function outdated(files, updated) {
  return files.flatMap((path) => {
    const text = readFileSync(path, "utf8");
    const now = updated(text);
    return now === text ? [] : [{ path, now }];
  });
}

/** @param {readonly string[]} files @param {(text: string) => string} updated */
export function rewrite(files, updated) {
  for (const { path, now } of outdated(files, updated)) writeFileSync(path, now);
}

/**
 * @param {readonly string[]} files
 * @param {(text: string) => string} updated
 * @param {string} source what the files follow from
 * @throws if one is out of date
 */
export function holdUpToDate(files, updated, source) {
  const paths = outdated(files, updated).map(({ path }) => path.slice(repository.length + 1));
  if (paths.length > 0) throw new Error(`${paths.join(", ")} disagree with ${source}. Remedy: npm run update.`);
}
