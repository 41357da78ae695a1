/** Hands files and texts to the browser. */
import { say } from "../state/announcement.js";

/** Saves a file. */
export function download(name: string, content: string | Uint8Array | Blob, type = "application/octet-stream"): void {
  const part = typeof content === "string" || content instanceof Blob ? content : Uint8Array.from(content);
  const address = URL.createObjectURL(new Blob([part], { type }));
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  link.click();
  // The browser has to have begun with it.
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
  say(`Saved ${name}.`);
}

/** Copies a text. */
export async function copy(text: string, what: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
    say(`Copied ${what}.`);
  } catch {
    say(`The browser does not let this page copy ${what}.`, "failed");
  }
}

/** A name that every file system takes. */
export const fileName = (name: string): string =>
  name
    .toLowerCase()
    .replace(/[^a-z0-9]+/g, "-")
    .replace(/^-|-$/g, "") || "object";
