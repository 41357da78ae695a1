/** The header: title, claim and help. */
import { signal } from "@preact/signals";
import { type Command, commands } from "../commands/shortcuts.js";

export const isHelpOpen = signal(false);

function toggleHelp(): void {
  isHelpOpen.value = !isHelpOpen.peek();
}

/** The commands with keys of the page: those of a scene, and its help. */
export const pageCommands: readonly Command[] = [...commands, { key: "?", title: "?", about: "Help", act: toggleHelp }];

export function Header() {
  return (
    <header class="head">
      <h1>sim3align</h1>
      <p class="claim">Place a 3D model in your photo at true scale.</p>
      <button type="button" id="help" onClick={toggleHelp} aria-keyshortcuts="?">
        Help
      </button>
    </header>
  );
}
