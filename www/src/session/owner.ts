/** Which tab a stored scene belongs to: only one tab at a time shows and changes it. Another one may take it over. */

import { newId } from "../state/inputs.js";

/** This tab. */
export const TAB = newId();

/** How long a tab may take to give up its scenes: those in the background are slow, and may have been frozen. */
const PATIENCE_MS = 2000;

/** The scenes of this tab, and what gives them up. */
const owned = new Map<string, () => void>();

/** Tells tabs which scenes another one wants. */
const channel = typeof BroadcastChannel === "undefined" ? null : new BroadcastChannel("sim3align");

let giveUp: (id: string) => Promise<void> = async () => {};

/** Stores a scene of this tab and forgets it here, when another tab takes it over. */
export function onTakenOver(listener: typeof giveUp): void {
  giveUp = listener;
}

channel?.addEventListener("message", async ({ data: id }: MessageEvent<string>) => {
  if (!owned.has(id)) return;
  await giveUp(id);
  disown(id);
});

/** Gives up a scene. */
export function disown(id: string): void {
  owned.get(id)?.();
  owned.delete(id);
}

/** Makes a scene that of this tab until the tab closes. Returns false if it is that of another tab. */
export const own = (id: string): Promise<boolean> => request(id, { ifAvailable: true });

/** Makes a scene that of this tab, also if it is that of another one. */
export async function takeOver(id: string): Promise<void> {
  channel?.postMessage(id);
  try {
    await request(id, { signal: AbortSignal.timeout(PATIENCE_MS) });
  } catch {
    await request(id, { steal: true });
  }
}

function request(id: string, options: LockOptions): Promise<boolean> {
  // Pages without encryption have no locks. There, the owner that is stored with each scene decides.
  if (owned.has(id) || navigator.locks === undefined) return Promise.resolve(true);
  return new Promise((resolve, reject) => {
    const hold = (lock: Lock | null) => {
      resolve(lock !== null);
      // The lock is held until this promise settles.
      return lock === null ? undefined : new Promise<void>((release) => owned.set(id, release));
    };
    navigator.locks.request(`sim3align ${id}`, options, hold).catch((cause) => {
      // Another tab has taken the lock without waiting.
      if (owned.delete(id)) giveUp(id);
      else reject(cause);
    });
  });
}
