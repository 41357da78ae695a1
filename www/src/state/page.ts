/** The workspace of the page. */
import { computed } from "@preact/signals";
import { effectiveTheme } from "./theme.js";
import { createWorkspace } from "./workspace.js";

export const page = createWorkspace({ theme: computed(effectiveTheme) });
