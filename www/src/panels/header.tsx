/** The header: title, sample and theme. */
import { openSample } from "../load/open.js";
import { sampleOf, samples } from "../load/samples.js";
import { alignAll } from "../run/align.js";
import { type Theme, theme } from "../state/display.js";
import { scene } from "../state/scene.js";
import { Choices } from "../ui/controls.js";
import { toggleHelp } from "../ui/shortcuts.js";

const themes: readonly [Theme, string][] = [
  ["system", "System"],
  ["light", "Light"],
  ["dark", "Dark"],
];

async function choose(id: string): Promise<void> {
  const sample = sampleOf(id);
  if (sample !== undefined && (await openSample(sample))) await alignAll();
}

export function Header() {
  const shown = scene.value?.sample ?? "";
  return (
    <header class="head">
      <h1>sim3align</h1>
      <p class="claim">
        <span>Aligns generated meshes with depth maps, at real size.</span> All data stay on this device.
      </p>
      <label class="field-inline">
        <span>Sample</span>
        <select id="sample" value={shown} onChange={({ currentTarget }) => choose(currentTarget.value)}>
          {shown === "" && <option value="">Own files</option>}
          {samples.map(({ id, title, about }) => (
            <option key={id} value={id} title={about}>
              {title}
            </option>
          ))}
        </select>
      </label>
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
