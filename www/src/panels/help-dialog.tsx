/** The help: what the page does, and its keys. */
import { useEffect, useRef } from "preact/hooks";
import { isHelpOpen } from "../ui/help.js";
import { shortcuts } from "../ui/shortcuts.js";

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
      <header>
        <h2 id="help-title">Help</h2>
        <form method="dialog">
          <button type="submit">Close</button>
        </form>
      </header>
      <p>
        A generated mesh has no size and no place. One depth map with a mask says how far away the visible part is. This
        page finds the one similarity transform between the two, <code>x_cam = s·R·p + t</code>: the mesh where the
        object is, at its real size.
      </p>
      <p>
        Drop a folder, a zip archive or single files anywhere: <code>depth.png</code> or <code>depth.npy</code>,{" "}
        <code>mask.png</code>, <code>mesh.glb</code>, <code>camera.json</code>, and a photo. For several objects,{" "}
        <code>mask-cup.png</code> goes with <code>mesh-cup.glb</code>. Everything is computed in this browser; nothing
        is sent anywhere.
      </p>
      <h3>Keys</h3>
      <dl class="keys">
        {shortcuts.map(({ key, shown, does }) => (
          <div key={key}>
            <dt>{shown.split(" ").map((part) => (part === "to" ? " to " : <kbd key={part}>{part}</kbd>))}</dt>
            <dd>{does}</dd>
          </div>
        ))}
      </dl>
    </dialog>
  );
}
