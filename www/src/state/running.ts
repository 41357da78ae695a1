/** Whether objects are being aligned, and how far. */
import { computed, signal } from "@preact/signals";
import type { SceneState } from "./scene.js";

/** The state of the alignments of a scene. */
export function runningState({ objects }: SceneState) {
  /** Aborts the alignment that is running; null while there is none. */
  const controller = signal<AbortController | null>(null);

  const isRunning = computed(() => controller.value !== null);

  /** Progress of all objects that are being aligned, 0 to 1. */
  const fraction = computed(() => {
    const runs = objects.value.map(({ run }) => run.value).filter(({ state }) => state !== "idle");
    const parts = runs.map((run) => (run.state === "running" ? run.fraction : run.state === "waiting" ? 0 : 1));
    return parts.length === 0 ? 0 : parts.reduce((sum, part) => sum + part, 0) / parts.length;
  });

  function cancel(): void {
    controller.peek()?.abort();
  }

  // Running alignments belong to the previous scene, and the new one need not wait for their end.
  objects.subscribe(() => {
    cancel();
    controller.value = null;
  });

  return { controller, isRunning, fraction, cancel };
}
