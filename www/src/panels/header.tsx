/** The header: title, claim, the way to the package and its documents, and help. */
import { signal } from "@preact/signals";
import { type Command, commands } from "../commands/shortcuts.js";
import { page } from "../state/page.js";
import { Menu } from "../ui/controls.js";

export const isHelpOpen = signal(false);

function toggleHelp(): void {
  isHelpOpen.value = !isHelpOpen.peek();
}

/** The commands with keys of the page: those of a scene, and its help. */
export const pageCommands: readonly Command[] = [
  ...commands,
  // The time axis listens to these.
  { key: "Frames", title: "Space ← →", about: "Play a video, show its frames", act: () => {} },
  { key: "?", title: "?", about: "Help", act: toggleHelp },
];

/** The address of the sources, inserted by the build. */
declare const SOURCE: string;

const INSTALL = "npm install sim3align";

const links = [
  ["Docs", "docs/readme.html"],
  ["Source", SOURCE],
  ["npm", "https://www.npmjs.com/package/sim3align"],
] as const;

const codes = [
  ["JavaScript", "javascript"],
  ["Command line", "commands"],
] as const;

const copyInstall = async () => (await import("../export/export.js")).copy(INSTALL, INSTALL);

async function copyCode(title: string, name: (typeof codes)[number][1]): Promise<void> {
  const [{ copy }, code] = await Promise.all([import("../export/export.js"), import("../export/code.js")]);
  await copy(code[name](), `the code (${title})`);
}

export const Header = () => (
  <header class="row head">
    <h1>sim3align</h1>
    <p class="claim">
      In: depth map, mask, 3D model. Out: <b>its real size and place</b>.
    </p>
  </header>
);

/** Beside the claim for the eye; for the Tab key after the scene, which is worked with all day. */
export function Tools() {
  const hasScene = page.scene.value !== null;
  return (
    <nav class="row tools" aria-label="Project">
      {links.map(([title, address]) => (
        <a key={title} href={address} target="_blank" rel="noreferrer">
          {title}
        </a>
      ))}
      <button type="button" class="install" title="Copy" onClick={copyInstall}>
        <code>{INSTALL}</code>
      </button>
      <Menu title="Copy code" label="Copy code that repeats this scene">
        {codes.map(([title, name]) => (
          <button key={name} type="button" disabled={!hasScene} onClick={() => copyCode(title, name)}>
            {title}
          </button>
        ))}
      </Menu>
      <button type="button" id="help" onClick={toggleHelp} aria-keyshortcuts="?">
        Help
      </button>
    </nav>
  );
}
