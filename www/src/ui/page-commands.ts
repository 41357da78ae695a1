/** Commands of the page that an embedded element does not have. */
import { isHelpOpen, isPaletteOpen } from "../state/help.js";
import { theme } from "../state/theme.js";
import { type Command, commands } from "./shortcuts.js";

export function toggleHelp(): void {
  isHelpOpen.value = !isHelpOpen.peek();
}

export function togglePalette(): void {
  isPaletteOpen.value = !isPaletteOpen.peek();
}

/** Presses a control that is somewhere on the page. */
const press = (id: string) => () => document.getElementById(id)?.click();

const choose = (name: typeof theme.value) => () => {
  theme.value = name;
};

export const pageCommands: readonly Command[] = [
  { key: "Mod+k", title: "Ctrl K", about: "Find a command", act: togglePalette, isGlobal: true },
  ...commands,
  { about: "Open files", act: press("files") },
  { about: "Open a folder", act: press("folder") },
  { about: "Change the files of the scene", act: press("edit-files") },
  { about: "Theme: system", act: choose("system") },
  { about: "Theme: light", act: choose("light") },
  { about: "Theme: dark", act: choose("dark") },
  { key: "?", title: "?", about: "Help", act: toggleHelp },
];
