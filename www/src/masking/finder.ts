/** Asks the worker for regions: one question at a time, and the newest only. */
import type { View } from "./grid.js";
import type { RegionCall } from "./region-worker.js";
import type { Stroke } from "./strokes.js";

export class Finder {
  readonly #worker = new Worker(new URL("./region-worker.ts", import.meta.url), { type: "module" });
  #isBusy = false;
  #next: readonly Stroke[] | null = null;

  /** @param onRegion is told the region of the newest strokes */
  constructor(view: View, onRegion: (region: Uint8Array) => void) {
    this.#send({ view, strokes: [] });
    this.#worker.addEventListener("message", ({ data }: MessageEvent<Uint8Array>) => {
      this.#isBusy = false;
      if (this.#next === null) return onRegion(data);
      const strokes = this.#next;
      this.#next = null;
      this.#send({ strokes });
    });
  }

  /** Finds the region of these strokes. */
  find(strokes: readonly Stroke[]): void {
    if (this.#isBusy) this.#next = strokes;
    else this.#send({ strokes });
  }

  stop(): void {
    this.#worker.terminate();
  }

  #send(call: RegionCall): void {
    this.#isBusy = true;
    this.#worker.postMessage(call);
  }
}
