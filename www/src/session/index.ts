/**
 * The session: the user's own scenes and videos, kept in the browser while they work. Each is kept by its id, and belongs to
 * one tab. A video counts as a scene.
 */

import { batch, effect, untracked } from "@preact/signals";
import { alignAll } from "../alignment/align.js";
import { openVideo, videoWork } from "../alignment/video.js";
import { readInputs, sceneOf } from "../input/reading.js";
import type { Inputs, NamedFile } from "../state/inputs.js";
import type { ObjectModel } from "../state/object-model.js";
import { stateOf } from "../state/object-work.js";
import { hasSession, page } from "../state/page.js";
import { isDoubtful, judged, type Progress } from "../state/progress.js";
import type { Scene } from "../state/scene.js";
import type { VideoWork } from "../state/video.js";
import { disown, onTakenOver, own } from "./owner.js";
import { applyState, type Packed, packed, progressOfPacked, type Settings, unpacked, videoWorkOf } from "./pack.js";
import { type SceneResult, sceneResult, videoResult } from "./results.js";
import { claimWork, forgetWork, storedFiles, storedWorks, storeWork, type Work } from "./store.js";

const { announce, enlist, fileActions, inputs, list, notKept, options, othersScenes, scene, select, show } = page;
const { support, video } = page;

/** Poses change with every frame of a drag. */
const DEBOUNCE_MS = 250;
/** Changes that go on, as while a video is tracked, are stored after this time. */
const LONGEST_MS = 2000;

/** What was done with the scenes of this tab, by their ids. */
const works = new Map<string, Work>();
/** The files of each that are stored. */
const stored = new Map<string, readonly NamedFile[]>();
/** The scenes with changes that are not stored yet. */
const unstored = new Set<string>();
/** The last transaction of each scene. */
const running = new Map<string, Promise<void>>();
let lastOrder = 0;
/** What is to be kept of the scene that is shown, once it has been unchanged for a while. */
let pending: { id: string; since: number; write(): void } | null = null;

/** Reads all that is stored of an object. */
const storedOf = (object: ObjectModel) => [object.name, stateOf(object)];

/** What is done in the scene that is shown; reading it subscribes to every change. */
function shownWork(): Scene | VideoWork | null {
  if (video.value !== null) return videoWork();
  for (const object of scene.value?.objects ?? []) storedOf(object);
  return scene.value;
}

/** Stores the scene that is shown, every change of it, and those that are still to be opened. Samples are not stored. */
export function keepSession(): void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  effect(() => {
    const [done, { id }, settings] = [shownWork(), inputs.value, { options: options.value, support: support.value }];
    clearTimeout(timer);
    // The changes of a scene that is left are not lost.
    if (pending !== null && pending.id !== id) untracked(pending.write);
    const since = pending?.id === id ? pending.since : performance.now();
    pending = null;
    const from = listed(id);
    // Between two scenes, one may have the work of the other.
    if (done === null || from === undefined || "framePoses" in done !== (from.frames !== undefined)) return;
    const write = () => {
      pending = null;
      keep(from, done, settings);
    };
    unstored.add(id);
    pending = { id, since, write };
    timer = setTimeout(write, Math.min(DEBOUNCE_MS, since + LONGEST_MS - performance.now()));
  });
  effect(() => {
    const waiting = list.value.filter(({ inputs: { id } }) => !works.has(id) && id !== inputs.peek().id);
    for (const { inputs: from } of waiting) untracked(() => keep(from, null, { options: options.peek() }));
  });
  addEventListener("beforeunload", (event) => {
    if (unstored.size > 0) event.preventDefault();
  });
  onTakenOver(giveUp);
}

/** Keeps what was done with a scene; null if it was not opened yet. */
export function keep(from: Inputs, done: Scene | VideoWork | null, settings: Settings, isShown = done !== null): void {
  const { id } = from;
  const { session, files } = packed(from, done, settings);
  const before = works.get(id);
  const work: Work = {
    ...{ id, session, order: before?.order ?? nextOrder(), result: done && resultOf(from, done) },
    shownAt: isShown ? Date.now() : (before?.shownAt ?? 0),
  };
  works.set(id, work);
  if (done !== null) setProgress(id, progressOfPacked(session));
  store(work, files);
}

const resultOf = (from: Inputs, done: Scene | VideoWork): SceneResult =>
  "objects" in done ? sceneResult(done, from) : videoResult(from.frames ?? [], done);

/** A scene as it is now: what was done with it and its files, as they are stored. */
export function workNow(from: Inputs): { work: Omit<Work, "id" | "order">; files: NamedFile[] } {
  const isShown = from.id === inputs.peek().id;
  const done = isShown ? untracked(shownWork) : null;
  const { session, files } = packed(from, done, { options: options.peek(), support: support.peek() });
  const before = works.get(from.id);
  const { result = null, shownAt = 0 } = before ?? {};
  return done === null
    ? { work: { session: before?.session ?? session, result, shownAt }, files }
    : { work: { session, result: resultOf(from, done), shownAt: Date.now() }, files };
}

function nextOrder(): number {
  lastOrder = Math.max(Date.now(), lastOrder + 1);
  return lastOrder;
}

export function setProgress(id: string, progress: Progress | null): void {
  list.value = list.peek().map((one) => (one.inputs.id === id ? { ...one, progress } : one));
}

function store(work: Work, files: readonly NamedFile[]): void {
  unstored.add(work.id);
  running.set(work.id, attempt(work, files));
}

async function attempt(work: Work, files: readonly NamedFile[]): Promise<void> {
  const { id, session } = work;
  const known = stored.get(id);
  const isSame = known !== undefined && files.length === known.length && files.every((file, i) => file === known[i]);
  try {
    await own(id);
    if (!(await storeWork(work, isSame ? null : files))) {
      // It waits for the end of this.
      giveUp(id);
      return;
    }
    stored.set(id, files);
    hasSession(true);
    // A change that was made meanwhile still waits to be written.
    if (works.get(id) === work && pending?.id !== id) unstored.delete(id);
    if (unstored.size === 0) notKept.value = null;
  } catch (cause) {
    const { name, message } = cause as Error;
    notKept.value =
      name === "QuotaExceededError"
        ? `The browser's storage is full: ${session.name} is not kept. Save the project as a file, or forget a scene.`
        : `The browser does not keep ${session.name} (${message || name}). Save the project as a file before you close this page.`;
  }
}

/**
 * Lists the scenes that the browser has kept, except those of other tabs, and shows the last one unless the address names
 * another one. Returns whether one is shown.
 */
export async function restoreSession(shows: boolean): Promise<boolean> {
  try {
    const found: Work[] = [];
    for (const work of await storedWorks()) {
      if (await own(work.id)) found.push(work);
      else othersScenes.value = [...othersScenes.peek(), { id: work.id, name: work.session.name }];
    }
    for (const work of found) await adopt(work);
    return shows && (await openLast(found));
  } catch (cause) {
    notKept.value = `What the browser has kept could not be opened (${(cause as Error).message}).`;
    return false;
  }
}

/** Lists a stored scene that has become one of this tab. */
export async function adopt(work: Work): Promise<void> {
  await claimWork(work.id);
  const files = await storedFiles(work.id);
  if (!enter(work, files))
    notKept.value = `Another version of this page has kept ${work.session.name}, which this one cannot open.`;
  else stored.set(work.id, packed(listed(work.id) as Inputs, null, { options: options.peek() }).files);
}

/** Adds a scene that is not stored yet, as it was saved, or as another tab has it. */
export function add(
  session: Packed,
  files: readonly NamedFile[],
  { id, result, shownAt }: Omit<Work, "session" | "order">,
): Work {
  const work = { id, session, result, order: nextOrder(), shownAt };
  if (enter(work, files)) store(work, packed(listed(id) as Inputs, null, { options: options.peek() }).files);
  return work;
}

/** Lists a scene with what was done. Returns false if it is one of another version. */
function enter(work: Work, files: readonly NamedFile[]): boolean {
  const from = unpacked(work.session, files, work.id);
  if (from === null) return false;
  works.set(work.id, work);
  enlist([from]);
  setProgress(work.id, progressOfPacked(work.session));
  return true;
}

const listed = (id: string): Inputs | undefined => list.peek().find((one) => one.inputs.id === id)?.inputs;

/** Shows the scene of these that was shown last. Returns whether there is one. */
export async function openLast(among: readonly Work[]): Promise<boolean> {
  const [last] = [...among].sort((a, b) => b.shownAt - a.shownAt);
  const from = last && listed(last.id);
  return last !== undefined && from !== undefined && (await open(last.session, from));
}

/** Shows a scene of the list as it was left. Returns false if it was not opened yet. */
export async function reopen(from: Inputs): Promise<boolean> {
  const work = works.get(from.id);
  if (work === undefined || work.result === null || !(await open(work.session, from))) return false;
  // It was left before it was aligned.
  const isBegun = ({ isPlaced, isHeld }: ObjectModel) => isPlaced || isHeld;
  if (video.peek() === null && scene.peek()?.objects.some(isBegun) === false) await alignAll(page);
  return true;
}

/** Forgets the scene that is shown. Another one takes its place. */
export async function forgetScene(): Promise<void> {
  const { id } = inputs.peek();
  // What is being stored would be stored once more.
  const last = running.get(id);
  await leave(id);
  await last;
  await forgetWork(id);
  disown(id);
  hasSession((await storedWorks()).length > 0);
  // There may be room for the others now.
  for (const { inputs: from } of list.peek()) {
    const work = works.get(from.id);
    if (unstored.has(from.id) && work !== undefined) store(work, packed(from, null, { options: options.peek() }).files);
  }
}

/** Leaves a scene to the tab that has taken it over, with all that was done. */
async function giveUp(id: string): Promise<void> {
  if (pending?.id === id) pending.write();
  await running.get(id);
  const work = works.get(id);
  if (work === undefined) return;
  const { name } = work.session;
  othersScenes.value = [...othersScenes.peek(), { id, name }];
  await leave(id);
  announce(`Another tab has taken over ${name}.`);
}

/** Takes a scene off the list and, if it is shown, shows another one. */
async function leave(id: string): Promise<void> {
  for (const kept of [works, stored, running, unstored]) kept.delete(id);
  list.value = list.peek().filter((one) => one.inputs.id !== id);
  if (inputs.peek().id !== id) return;
  pending = null;
  inputs.value = { ...inputs.peek(), id: "" };
  await fileActions.peek()?.another();
}

/** The number of the last scene that was opened. Those that are read more slowly are not shown. */
let lastOpening = 0;

async function open(session: Packed, named: Inputs): Promise<boolean> {
  if (named.frames !== undefined) {
    const isOpen = await openVideo(named, videoWorkOf(session));
    if (isOpen) announce(`Restored ${named.name}.`);
    return isOpen;
  }
  // Objects may have other names than their files.
  const objects = named.objects.map((one, i) => ({ ...one, name: session.objects[i]?.name ?? one.name }));
  const from = { ...named, objects };
  const call = ++lastOpening;
  const reading = await readInputs(from);
  if (call !== lastOpening) return true;
  const opened = sceneOf(from, reading);
  if (opened === null) return false;
  batch(() => {
    show(opened, from);
    applyState(session, page);
    // What waits for a person.
    const isOpen = ({ verdict }: ObjectModel) => verdict.value === null;
    const waiting = opened.objects.find((one) => isDoubtful(judged(one))) ?? opened.objects.find(isOpen);
    if (waiting !== undefined) select(waiting.id);
  });
  // Nobody has seen one that was aligned in the background.
  announce(works.get(from.id)?.shownAt === 0 ? `Aligned ${from.name} in the background.` : `Restored ${from.name}.`);
  return true;
}
