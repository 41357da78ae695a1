/** The status line: shown on the page and read out by screen readers. */
import { signal } from "@preact/signals";

export interface Status {
  text: string;
  kind: "working" | "done" | "failed";
}

export const status = signal<Status>({ text: "Loading …", kind: "working" });

export const announce = (text: string, kind: Status["kind"] = "done"): void => {
  status.value = { text, kind };
};
