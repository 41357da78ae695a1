/** Which tab a stored scene belongs to: only one tab at a time shows and changes it. */

const owned = new Set<string>();

/** Makes a scene that of this tab until the tab closes. Returns false if it is that of another tab. */
export function own(id: string): Promise<boolean> {
  // Pages without encryption have no locks. There, two tabs may store the same scene in turn.
  if (owned.has(id) || navigator.locks === undefined) return Promise.resolve(true);
  return new Promise((resolve, reject) => {
    const hold = (lock: Lock | null) => {
      if (lock !== null) owned.add(id);
      resolve(lock !== null);
      // The lock is held until this promise settles.
      return lock === null ? undefined : new Promise<void>(() => {});
    };
    navigator.locks.request(`sim3align ${id}`, { ifAvailable: true }, hold).catch(reject);
  });
}
