/** The project: all scenes of this tab in one file, with what was done, and its results as plain data. */

import { type Inputs, type NamedFile, newId } from "../state/inputs.js";
import { page } from "../state/page.js";
import { add, openLast, workNow } from "./index.js";
import { isSession, type Packed, SESSION_FILE, sessionParts } from "./pack.js";
import type { SceneResult } from "./results.js";
import type { Work } from "./store.js";

const { inputs, list } = page;

/** The scenes of this tab. A sample that is shown is not listed. */
function scenes(): Inputs[] {
  const own = list.peek().map(({ inputs }) => inputs);
  const shown = inputs.peek();
  return shown.id === "" ? [...own, shown] : own;
}

/** The results of all scenes by their names; null for those that were not opened yet. */
export function allResults(): Record<string, SceneResult | null> {
  const results: Record<string, SceneResult | null> = {};
  for (const from of scenes()) {
    let [key, number] = [from.name, 1];
    while (key in results) key = `${from.name} ${++number}`;
    results[key] = workNow(from).work.result as SceneResult | null;
  }
  return results;
}

/** What a project file has of a scene. */
type Saved = Packed & Pick<Work, "result" | "shownAt">;

/** The project as one file: a zip archive of the files of every scene, of what was done with it, and of all results. */
export async function projectFile(): Promise<Uint8Array> {
  const { zipSync } = await import("fflate");
  const text = (of: unknown) => new TextEncoder().encode(JSON.stringify(of, null, 2));
  const entries: Record<string, Uint8Array> = { "results.json": text(allResults()) };
  for (const [k, from] of scenes().entries()) {
    const { work, files } = workNow(from);
    const { session, ...rest } = work;
    const saved: Saved = { ...session, ...rest };
    entries[`${k + 1}/${SESSION_FILE}`] = text(saved);
    // The indices keep files with equal paths apart.
    for (const [i, { path, bytes }] of files.entries()) entries[`${k + 1}/${i}/${path}`] = await bytes();
  }
  return zipSync(entries, { level: 1 });
}

/**
 * Opens a project file, given as the files in it, beside the scenes that are there, and shows the one that was shown when it
 * was saved. Returns whether it can be opened.
 */
export async function openProject(files: readonly NamedFile[]): Promise<boolean> {
  const opened = [];
  for (const own of files.filter(isSession)) {
    const parts = await sessionParts<Saved>(files, own);
    const { result, shownAt, ...session } = parts.session;
    opened.push(add(session, parts.files, { id: newId(), result, shownAt }));
  }
  return openLast(opened);
}
