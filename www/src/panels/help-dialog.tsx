/** The help dialog. */
import { useEffect, useRef } from "preact/hooks";
import { formatsText } from "sim3align/input/formats";
import { type Theme, theme } from "../state/page.js";
import { Choices } from "../ui/controls.js";
import { isHelpOpen, pageCommands } from "./header.js";

/** A key of a command, such as "Ctrl Shift Z" or "0 to 9". */
const Keys = ({ title }: { title: string }) => (
  <span class="key">{title.split(" ").map((part) => (part === "to" ? " to " : <kbd key={part}>{part}</kbd>))}</span>
);

/** Titles and addresses, inserted by the build. */
declare const DOCUMENTS: readonly (readonly [title: string, address: string])[];

const themes: readonly [Theme, string][] = [
  ["system", "System"],
  ["light", "Light"],
  ["dark", "Dark"],
];

export function HelpDialog() {
  const dialog = useRef<HTMLDialogElement>(null);
  const isOpen = isHelpOpen.value;
  useEffect(() => {
    if (isOpen && dialog.current?.open === false) dialog.current.showModal();
    if (!isOpen) dialog.current?.close();
  }, [isOpen]);
  return (
    <dialog
      ref={dialog}
      class="help"
      aria-labelledby="help-title"
      onClose={() => {
        isHelpOpen.value = false;
      }}
    >
      <header class="row">
        <h2 id="help-title">Help</h2>
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
        <form method="dialog">
          <button type="submit">Close</button>
        </form>
      </header>
      <p>
        A generated mesh has no real size and no place. A depth map with a mask shows where the visible part of the
        object is. This page finds the size, the place and the turn at which the mesh is that object.
      </p>
      <p>
        Drop a folder, a zip archive or single files anywhere on the page: a depth map ({formatsText("depth")}),{" "}
        <code>mask.png</code>, <code>mesh.glb</code>, and optionally a photo and <code>camera.json</code>. Without a
        camera, its focal length is that of the depth file or of the photo, or estimated. Relative depth gives sizes
        without a unit, until you enter a known one. For several objects, use matching names: <code>mask-cup.png</code>{" "}
        goes with <code>mesh-cup.glb</code>. Everything is computed in this browser; nothing is uploaded.
      </p>
      <h3>Documentation</h3>
      <ul class="documents">
        {DOCUMENTS.map(([title, address]) => (
          <li key={address}>
            <a href={address} target="_blank" rel="noreferrer">
              {title}
            </a>
          </li>
        ))}
      </ul>
      <h3>Keyboard shortcuts</h3>
      <dl class="keys">
        {pageCommands.map(
          ({ key, title, about }) =>
            title !== undefined && (
              <div key={key}>
                <dt>
                  <Keys title={title} />
                </dt>
                <dd>{about}</dd>
              </div>
            ),
        )}
      </dl>
    </dialog>
  );
}
