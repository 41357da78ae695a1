/** Whether the help of the page is open. */
import { signal } from "@preact/signals";

export const isHelpOpen = signal(false);
