/** The status line: shown on the page and read out by screen readers. */
import { signal } from "@preact/signals";

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
