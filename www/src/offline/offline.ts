/** Use of the page without a connection. */
import { signal } from "@preact/signals";

/** Whether the page is stored in this browser, and whether a newer one is. */
export const offlineState = signal<"unknown" | "stored" | "newer">("unknown");

/** Stores the page by a service worker. Where there is none, the page works as without it. */
export async function storePage(): Promise<void> {
  const workers = navigator.serviceWorker;
  if (workers === undefined) return;
  const isFirst = workers.controller === null;
  try {
    const registration = await workers.register(new URL("service-worker.js", document.baseURI));
    const follow = (worker: ServiceWorker | null) => {
      const note = () => {
        const isWaiting = worker?.state === "installed";
        // The registration may name its waiting worker later than the worker its state.
        if (isWaiting || worker?.state === "activated") offlineState.value = isWaiting && !isFirst ? "newer" : "stored";
      };
      worker?.addEventListener("statechange", note);
      note();
    };
    follow(registration.active);
    follow(registration.waiting);
    follow(registration.installing);
    registration.addEventListener("updatefound", () => follow(registration.installing));
  } catch {
    // Browsers refuse workers in private windows and without HTTPS.
  }
}
