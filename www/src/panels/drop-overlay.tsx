/** The whole page takes files; while some are held over it, it says which. */
import { useEffect, useState } from "preact/hooks";
import { droppedFiles } from "../load/archive.js";
import { openFiles } from "../load/open.js";

const hasFiles = ({ dataTransfer }: DragEvent) => dataTransfer?.types.includes("Files") === true;

export function DropOverlay() {
  const [isOver, setOver] = useState(false);
  useEffect(() => {
    const listening = new AbortController();
    const { signal } = listening;
    // Every element that the pointer crosses has an enter and a leave of its own.
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
    return () => listening.abort();
  }, []);
  return isOver ? <p class="drop-here">Drop depth, mask, mesh and camera, or a case folder or zip</p> : null;
}
