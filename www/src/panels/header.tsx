/** The header: title, claim, commands and help. */
import { toggleHelp, togglePalette } from "../commands/page-commands.js";

export function Header() {
  return (
    <header class="head">
      <h1>sim3align</h1>
      <p class="claim">Place a 3D model in your photo at true scale.</p>
      <button type="button" id="commands" onClick={togglePalette} aria-keyshortcuts="Control+K Meta+K">
        Commands <kbd>Ctrl K</kbd>
      </button>
      <button type="button" onClick={toggleHelp} aria-keyshortcuts="?">
        Help
      </button>
    </header>
  );
}
