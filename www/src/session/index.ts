/**
 * The session: the user's own scenes, kept in the browser while they work and each saved and opened as one file. A scene is
 * kept by its id, and belongs to one tab.
 */
import { batch, effect, untracked } from "@preact/signals";
import { type SceneResult, sceneResult } from "../export/results.js";
import type { NamedFile } from "../load/files.js";
import type { Inputs } from "../load/inputs.js";
import { readInputs, sceneOf } from "../load/read-scene.js";
import { alignAll } from "../run/align.js";
import { page } from "../state/page.js";
import type { Scene } from "../state/scene.js";
import { hasSession } from "../state/session-flag.js";
import { own } from "./owner.js";
import { applyState, type Packed, packed, SESSION_FILE, sessionParts, unpacked } from "./pack.js";
import { forgetWork, storedFiles, storedWorks, storeWork, type Work } from "./store.js";

const { announce, enlist, inputs, list, options, othersScenes, scene, show } = page;

/** Poses change with every frame of a drag. */
const DEBOUNCE_MS = 250;

/** What was done with the scenes of this tab, by their ids. */
const works = new Map<string, Work>();
/** The files of each that are stored. */
const stored = new Map<string, readonly NamedFile[]>();
/** The scenes with changes that are not stored yet. */
const unstored = new Set<string>();
let lastOrder = 0;
/** What is to be kept of the scene that is shown, once it has been unchanged for a while. */
let pending: { id: string; write(): void } | null = null;

/** Stores the scene that is shown, every change of it, and those that are still to be opened. Samples and videos are not stored. */
export function keepSession(): void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  effect(() => {
    const [whole, from] = [scene.value, inputs.value];
    clearTimeout(timer);
    // The changes of a scene that is left are not lost.
    if (pending !== null && pending.id !== from.id) untracked(pending.write);
    pending = null;
    if (whole === null || from.id === "") return;
    // Reading the signals of the objects subscribes to them.
    packed(from, whole, options.value);
    const write = () => {
      pending = null;
      keep(from, whole);
    };
    unstored.add(from.id);
    pending = { id: from.id, write };
    timer = setTimeout(write, DEBOUNCE_MS);
  });
  effect(() => {
    const waiting = list.value.filter(({ inputs: { id } }) => !works.has(id) && id !== inputs.peek().id);
    for (const { inputs: from } of waiting) untracked(() => keep(from, null));
  });
  addEventListener("beforeunload", (event) => {
    if (unstored.size > 0) event.preventDefault();
  });
}

/** Keeps what was done with a scene; null if it was not opened yet. */
function keep(from: Inputs, whole: Scene | null): void {
  const { id } = from;
  const { session, files } = packed(from, whole, options.peek());
  const before = works.get(id);
  lastOrder = Math.max(Date.now(), lastOrder + 1);
  const work: Work = {
    ...{ id, session, order: before?.order ?? lastOrder },
    result: whole === null ? null : sceneResult(whole),
    shownAt: whole === null ? 0 : Date.now(),
  };
  works.set(id, work);
  if (whole !== null) {
    const accepted = whole.objects.filter(({ isAccepted }) => isAccepted.peek()).length;
    const progress = { objects: whole.objects.length, accepted };
    list.value = list.peek().map((one) => (one.inputs.id === id ? { ...one, progress } : one));
  }
  store(work, files);
}

async function store(work: Work, files: readonly NamedFile[]): Promise<void> {
  const known = stored.get(work.id);
  const isSame = known !== undefined && files.length === known.length && files.every((file, i) => file === known[i]);
  unstored.add(work.id);
  try {
    await own(work.id);
    await storeWork(work, isSame ? null : files);
    stored.set(work.id, files);
    hasSession(true);
    if (works.get(work.id) === work) unstored.delete(work.id);
  } catch {
    // The database may be blocked or full: leaving the page then asks.
  }
}

/** Lists the scenes that the browser has kept, except those of other tabs, and shows the last one. Returns whether there is one. */
export async function restoreSession(): Promise<boolean> {
  try {
    const found: Work[] = [];
    for (const work of await storedWorks()) {
      if (await own(work.id)) found.push(work);
      else othersScenes.value = [...othersScenes.peek(), work.session.name];
    }
    for (const work of found) {
      const files = await storedFiles(work.id);
      const from = unpacked(work.session, files, work.id);
      if (from === null) continue;
      works.set(work.id, work);
      stored.set(work.id, packed(from, null, options.peek()).files);
      enlist([from]);
      const states = work.session.objects.map(({ state }) => state);
      const accepted = states.filter((state) => state?.isAccepted).length;
      const progress = states.some((state) => state !== null) ? { objects: states.length, accepted } : null;
      list.value = list.peek().map((one) => (one.inputs === from ? { ...one, progress } : one));
    }
    const last = [...works.values()].sort((a, b) => b.shownAt - a.shownAt)[0];
    const from = list.peek().find((one) => one.inputs.id === last?.id)?.inputs;
    return last !== undefined && from !== undefined && (await open(last.session, from));
  } catch {
    return false;
  }
}

/** Shows a scene of the list as it was left. Returns false if it was not opened yet. */
export async function reopen(from: Inputs): Promise<boolean> {
  const work = works.get(from.id);
  if (work === undefined || work.shownAt === 0 || !(await open(work.session, from))) return false;
  // It was left before it was aligned.
  if (scene.peek()?.objects.every(({ isPlaced }) => !isPlaced) === true) await alignAll(page);
  return true;
}

/** Forgets the scene that is shown. */
export async function forgetScene(): Promise<void> {
  const { id } = inputs.peek();
  pending = null;
  inputs.value = { ...inputs.peek(), id: "" };
  works.delete(id);
  stored.delete(id);
  unstored.delete(id);
  list.value = list.peek().filter((one) => one.inputs.id !== id);
  await forgetWork(id);
  hasSession((await storedWorks()).length > 0);
}

async function open(session: Packed, named: Inputs): Promise<boolean> {
  // Objects may have other names than their files.
  const objects = named.objects.map((one, i) => ({ ...one, name: session.objects[i]?.name ?? one.name }));
  const from = { ...named, objects };
  const reading = await readInputs(from);
  const opened = sceneOf(from, reading);
  if (opened === null) return false;
  batch(() => {
    show(opened, from);
    applyState(session, page);
  });
  announce(`Restored ${from.name}.`);
  return true;
}

/** The results of all scenes of the list by their names; null for those that were not opened yet. */
export function allResults(): Record<string, SceneResult | null> {
  const results: Record<string, SceneResult | null> = {};
  for (const { inputs: from } of list.peek()) {
    const isShown = from.id === inputs.peek().id;
    const whole = scene.peek();
    const result = isShown && whole !== null ? sceneResult(whole) : (works.get(from.id)?.result as SceneResult | null);
    let [key, number] = [from.name, 1];
    while (key in results) key = `${from.name} ${++number}`;
    results[key] = result ?? null;
  }
  return results;
}

/** The session as one file: a zip archive of the scene's files, and what was done with its objects. */
export async function sessionFile(): Promise<Uint8Array | null> {
  const whole = scene.peek();
  if (whole === null) return null;
  const { zipSync } = await import("fflate");
  const { session, files } = packed(inputs.peek(), whole, options.peek());
  const entries: Record<string, Uint8Array> = { [SESSION_FILE]: new TextEncoder().encode(JSON.stringify(session)) };
  // The indices keep files with equal paths apart.
  for (const [i, { path, bytes }] of files.entries()) entries[`${i}/${path}`] = await bytes();
  return zipSync(entries, { level: 1 });
}

/** Opens a session file, given as the files in it. Returns whether it is one that can be opened. */
export async function openSession(files: readonly NamedFile[]): Promise<boolean> {
  const parts = await sessionParts(files);
  const from = parts && unpacked(parts.session, parts.files);
  return parts !== null && from !== null && open(parts.session, from);
}
