/** The workspace of the page, its theme, and whether a session is stored. */
import { computed, effect, signal } from "@preact/signals";
import { createWorkspace } from "./workspace.js";

export type Theme = "system" | "light" | "dark";

const THEME_KEY = "sim3align-theme";

function storedTheme(): Theme {
  try {
    const theme = localStorage.getItem(THEME_KEY);
    return theme === "light" || theme === "dark" ? theme : "system";
  } catch {
    // Storage may be blocked.
    return "system";
  }
}

export const theme = signal<Theme>(storedTheme());

const darkQuery = matchMedia("(prefers-color-scheme: dark)");
const systemIsDark = signal(darkQuery.matches);
darkQuery.addEventListener("change", ({ matches }) => {
  systemIsDark.value = matches;
});

/** The theme in effect. */
export const effectiveTheme = () => (theme.value === "system" ? (systemIsDark.value ? "dark" : "light") : theme.value);

effect(() => {
  document.documentElement.style.colorScheme = theme.value === "system" ? "light dark" : theme.value;
  try {
    if (theme.value === "system") localStorage.removeItem(THEME_KEY);
    else localStorage.setItem(THEME_KEY, theme.value);
  } catch {
    // Storage is blocked: the theme is lost when the page closes.
  }
});

const KEY = "sim3align-session";

/** Reads the flag or, with an argument, sets it. */
export function hasSession(value?: boolean): boolean {
  try {
    if (value === true) localStorage.setItem(KEY, "1");
    else if (value === false) localStorage.removeItem(KEY);
    return localStorage.getItem(KEY) === "1";
  } catch {
    // Storage may be blocked.
    return false;
  }
}

export const page = createWorkspace({ theme: computed(effectiveTheme) });
