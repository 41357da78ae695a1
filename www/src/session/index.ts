/** The session: kept in the browser while the user works, and saved and opened as one file. */
import { batch, effect } from "@preact/signals";
import type { NamedFile } from "../load/files.js";
import { readInputs, sceneOf } from "../load/read-scene.js";
import { page } from "../state/page.js";
import { hasSession } from "../state/session-flag.js";
import { applyState, type Packed, packed, SESSION_FILE, sessionParts, unpacked } from "./pack.js";
import { clearSession, storedSession, storeFiles, storeSession } from "./store.js";

const { announce, inputs, options, scene, show, video } = page;

/** Poses change with every frame of a drag. */
const DEBOUNCE_MS = 250;
/** Whether all changes are stored. */
let isStored = true;

/** Stores the scene that is shown, and every change of it. Samples and videos are not stored. */
export function keepSession(): void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  let stored: readonly NamedFile[] = [];
  effect(() => {
    const [whole, from] = [scene.value, inputs.value];
    clearTimeout(timer);
    if (whole === null || whole.sample !== null || video.value !== null) return;
    // Reading the signals of the objects subscribes to them.
    const { session, files } = packed(from, whole, options.value);
    isStored = false;
    timer = setTimeout(async () => {
      try {
        if (files.length !== stored.length || files.some((file, i) => file !== stored[i])) await storeFiles(files);
        stored = files;
        await storeSession(session);
        hasSession(true);
        isStored = true;
      } catch {
        // The database may be blocked or full: leaving the page then asks.
      }
    }, DEBOUNCE_MS);
  });
  addEventListener("beforeunload", (event) => {
    if (!isStored) event.preventDefault();
  });
}

/** Shows the session that the browser has kept. Returns whether there is one. */
export async function restoreSession(): Promise<boolean> {
  try {
    const kept = await storedSession();
    return kept !== null && (await open(kept.session, kept.files));
  } catch {
    return false;
  }
}

/** Forgets the kept session. */
export async function forgetSession(): Promise<void> {
  hasSession(false);
  await clearSession();
}

async function open(session: Packed, files: readonly NamedFile[]): Promise<boolean> {
  const from = unpacked(session, files);
  if (from === null) return false;
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
  return parts !== null && open(parts.session, parts.files);
}
