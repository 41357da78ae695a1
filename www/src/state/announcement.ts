/** What is said to those who listen to the page, and shown in its status line. */
import { signal } from "@preact/signals";

export interface Announcement {
  text: string;
  kind: "working" | "done" | "failed";
}

export const announcement = signal<Announcement>({ text: "Loading …", kind: "working" });

export const say = (text: string, kind: Announcement["kind"] = "done"): void => {
  announcement.value = { text, kind };
};
