/** The command palette: every command with its key, filtered by typing. */
import { useEffect, useRef, useState } from "preact/hooks";
import { commandsNow } from "../commands/palette-commands.js";
import type { Command } from "../commands/shortcuts.js";
import { isPaletteOpen } from "../state/help.js";
import { page } from "../state/page.js";
import { Keys } from "./keys.js";

/** The commands whose text contains all words. */
function matches(query: string): readonly Command[] {
  const words = query.toLowerCase().split(/\s+/);
  return commandsNow().filter(({ about }) => words.every((word) => about.toLowerCase().includes(word)));
}

export function Palette() {
  const dialog = useRef<HTMLDialogElement>(null);
  const [query, setQuery] = useState("");
  const [chosen, setChosen] = useState(0);
  const isOpen = isPaletteOpen.value;
  useEffect(() => {
    if (!isOpen) return dialog.current?.close();
    setQuery("");
    setChosen(0);
    if (dialog.current?.open === false) dialog.current.showModal();
  }, [isOpen]);
  const found = matches(query);
  const idOf = (index: number) => `command-${index}`;
  useEffect(() => document.getElementById(idOf(chosen))?.scrollIntoView({ block: "nearest" }), [chosen]);

  const run = (command: Command | undefined) => {
    if (command === undefined) return;
    // Closing gives the focus back, so that a command may move it. Its event comes later, and the next key may be first.
    dialog.current?.close();
    isPaletteOpen.value = false;
    command.act(page);
  };
  const onKeyDown = (event: KeyboardEvent) => {
    const steps: Record<string, number> = { ArrowDown: chosen + 1, ArrowUp: chosen - 1 };
    const next = steps[event.key];
    if (event.key === "Enter") run(found[chosen]);
    else if (event.key.toLowerCase() === "k" && (event.ctrlKey || event.metaKey)) dialog.current?.close();
    else if (next === undefined || found.length === 0) return;
    else setChosen((next + found.length) % found.length);
    event.preventDefault();
  };
  return (
    <dialog
      ref={dialog}
      class="help palette"
      aria-label="Commands"
      onClose={() => {
        isPaletteOpen.value = false;
      }}
    >
      <input
        role="combobox"
        aria-label="Find a command"
        aria-expanded="true"
        aria-controls="command-list"
        aria-autocomplete="list"
        aria-activedescendant={found.length > 0 ? idOf(chosen) : undefined}
        placeholder="Find a command"
        autocomplete="off"
        spellcheck={false}
        value={query}
        onInput={({ currentTarget }) => {
          setQuery(currentTarget.value);
          setChosen(0);
        }}
        onKeyDown={onKeyDown}
      />
      <div role="listbox" id="command-list" aria-label="Commands" tabIndex={-1}>
        {found.map((command, i) => (
          // biome-ignore lint/a11y/useKeyWithClickEvents: the field above has the focus and handles the keys.
          <div
            key={idOf(i)}
            id={idOf(i)}
            role="option"
            tabIndex={-1}
            aria-selected={i === chosen}
            onClick={() => run(command)}
          >
            {command.about}
            {command.title !== undefined && <Keys title={command.title} />}
          </div>
        ))}
      </div>
      {found.length === 0 && <p class="quiet">No command contains this.</p>}
    </dialog>
  );
}
