/** The header: title, claim, theme and help. */
import { type Theme, theme } from "../state/theme.js";
import { Choices } from "../ui/controls.js";
import { toggleHelp } from "../ui/shortcuts.js";

const themes: readonly [Theme, string][] = [
  ["system", "System"],
  ["light", "Light"],
  ["dark", "Dark"],
];

export function Header() {
  return (
    <header class="head">
      <h1>sim3align</h1>
      <p class="claim">Place a 3D model in your photo at true scale.</p>
      <label class="field-inline" for="theme">
        <span>Theme</span>
        <Choices
          id="theme"
          value={theme.value}
          choices={themes}
          onChoose={(chosen) => {
            theme.value = chosen;
          }}
        />
      </label>
      <button type="button" onClick={toggleHelp} aria-keyshortcuts="?">
        Help
      </button>
    </header>
  );
}
