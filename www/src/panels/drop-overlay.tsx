/** Accepts files that are dropped or pasted anywhere on the page. */
import { useEffect, useState } from "preact/hooks";
import { droppedFiles, fromFile } from "../input/files.js";
import { openFiles } from "../opening/open.js";

const hasFiles = ({ dataTransfer }: DragEvent) => dataTransfer?.types.includes("Files") === true;

export function DropOverlay() {
  const [isOver, setOver] = useState(false);
  useEffect(() => {
    const listening = new AbortController();
    const { signal } = listening;
    // Every element that the pointer crosses fires its own enter and leave events.
    let entered = 0;
    const count = (step: number) => (event: DragEvent) => {
      if (!hasFiles(event)) return;
      entered = Math.max(0, entered + step);
      setOver(entered > 0);
    };
    addEventListener("dragenter", count(1), { signal });
    addEventListener("dragleave", count(-1), { signal });
    addEventListener("dragover", (event) => hasFiles(event) && event.preventDefault(), { signal });
    const drop = async (event: DragEvent) => {
      if (event.dataTransfer === null || !hasFiles(event)) return;
      event.preventDefault();
      entered = 0;
      setOver(false);
      await openFiles(await droppedFiles(event.dataTransfer));
    };
    addEventListener("drop", drop, { signal });
    const paste = (event: ClipboardEvent) => {
      const files = Array.from(event.clipboardData?.files ?? [], (file) => fromFile(file));
      if (files.length === 0) return;
      event.preventDefault();
      openFiles(files);
    };
    addEventListener("paste", paste, { signal });
    return () => listening.abort();
  }, []);
  return isOver ? (
    <p class="drop-here">Drop depth map, masks, meshes and camera, or a folder or zip archive with them</p>
  ) : null;
}
