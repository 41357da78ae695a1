/** Whether objects are being aligned, how far, and the status line. */
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

export interface Status {
  text: string;
  kind: "working" | "done" | "failed";
}

/** The state of the status line. */
export function statusState() {
  const status = signal<Status>({ text: "Loading …", kind: "working" });

  const announce = (text: string, kind: Status["kind"] = "done"): void => {
    status.value = { text, kind };
  };

  return { status, announce };
}

export type StatusState = ReturnType<typeof statusState>;
