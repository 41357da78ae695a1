/** The project: all scenes of this tab in one file, with what was done, and its results as plain data. */
import { type SceneResult, sceneResult } from "../export/results.js";
import type { NamedFile } from "../load/files.js";
import { type Inputs, newId } from "../load/inputs.js";
import { page } from "../state/page.js";
import { add, openLast, workOf } from "./index.js";
import { isSession, type Packed, packed, SESSION_FILE, sessionParts } from "./pack.js";
import type { Work } from "./store.js";

const { inputs, list, options, scene } = page;

/** The scenes of this tab. A sample that is shown is not listed. */
function scenes(): Inputs[] {
  const own = list.peek().map(({ inputs }) => inputs);
  const shown = inputs.peek();
  return shown.id === "" ? [...own, shown] : own;
}

const isShown = ({ id }: Inputs) => id === inputs.peek().id && scene.peek() !== null;

function resultOf(from: Inputs): SceneResult | null {
  const whole = scene.peek();
  if (isShown(from) && whole !== null) return sceneResult(whole, from);
  return (workOf(from.id)?.result as SceneResult | undefined) ?? null;
}

/** The results of all scenes by their names; null for those that were not opened yet. */
export function allResults(): Record<string, SceneResult | null> {
  const results: Record<string, SceneResult | null> = {};
  for (const from of scenes()) {
    let [key, number] = [from.name, 1];
    while (key in results) key = `${from.name} ${++number}`;
    results[key] = resultOf(from);
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
    const work = workOf(from.id);
    const own = packed(from, isShown(from) ? scene.peek() : null, options.peek());
    const session = isShown(from) ? own.session : (work?.session ?? own.session);
    const shownAt = isShown(from) ? Date.now() : (work?.shownAt ?? 0);
    const saved: Saved = { ...session, result: resultOf(from), shownAt };
    entries[`${k + 1}/${SESSION_FILE}`] = text(saved);
    // The indices keep files with equal paths apart.
    for (const [i, { path, bytes }] of own.files.entries()) entries[`${k + 1}/${i}/${path}`] = await bytes();
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
