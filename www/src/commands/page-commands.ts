/** The commands with keys of the page: those of a scene, and its dialogs. */
import { isHelpOpen, isPaletteOpen } from "../state/help.js";
import { type Command, commands, isNever } from "./shortcuts.js";

export function toggleHelp(): void {
  isHelpOpen.value = !isHelpOpen.peek();
}

export function togglePalette(): void {
  isPaletteOpen.value = !isPaletteOpen.peek();
}

export const pageCommands: readonly Command[] = [
  { key: "Mod+k", title: "Ctrl K", about: "Find a command", act: togglePalette, isGlobal: true, isOffered: isNever },
  ...commands,
  { key: "?", title: "?", about: "Help", act: toggleHelp },
];
