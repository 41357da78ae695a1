/** The mask tool: clicks and strokes of a brush on the photo. */
import { useEffect, useRef, useState } from "preact/hooks";
import { percent } from "../ui/texts.js";
import { Brush, firstBrush } from "./brush.js";
import type { View } from "./grid.js";
import { useMask } from "./mask.js";
import { type Pixel, Stage } from "./stage.js";
import type { Mark } from "./strokes.js";

interface EditorProps {
  /** The name of the object. */
  name: string;
  view: View & { rgba: Uint8ClampedArray };
  colour: string;
  /** A mask that is there already, at the size of the view. */
  before: Uint8Array | null;
  /** The marks of a mask that was made here. */
  marks: readonly Mark[];
  onDone(mask: Uint8Array, marks: readonly Mark[]): Promise<void>;
  onCancel(): void;
}

export function MaskEditor({ name, view, colour, before, marks: first, ...on }: EditorProps) {
  const { width, height } = view;
  const dialog = useRef<HTMLDialogElement>(null);
  const [marks, setMarks] = useState(first);
  const [undone, setUndone] = useState<readonly Mark[]>([]);
  const [brush, setBrush] = useState(firstBrush(Math.max(width, height)));
  const [cross, setCross] = useState<Pixel>([Math.round(width / 2), Math.round(height / 2)]);
  const [isWaiting, setWaiting] = useState(false);
  const [failure, setFailure] = useState("");
  const { mask, share, isBusy: isSearching } = useMask(view, marks, before);
  const isBusy = isSearching || isWaiting;

  useEffect(() => {
    if (dialog.current?.open === false) dialog.current.showModal();
    dialog.current?.querySelector<HTMLElement>("#mask-here")?.focus();
  }, []);

  const put = (mark: Mark) => {
    setMarks([...marks, mark]);
    setUndone([]);
  };
  const undo = () => {
    setMarks(marks.slice(0, -1));
    setUndone([...undone, ...marks.slice(-1)]);
  };
  const redo = () => {
    setMarks([...marks, ...undone.slice(-1)]);
    setUndone(undone.slice(0, -1));
  };
  const onKeyDown = (event: KeyboardEvent) => {
    if (!event.ctrlKey && !event.metaKey) return;
    const key = event.key.toLowerCase();
    if (key !== "z" && key !== "y") return;
    event.preventDefault();
    event.stopPropagation();
    if (key === "y" || event.shiftKey) redo();
    else undo();
  };

  const attempt = async (work: () => Promise<void>) => {
    setWaiting(true);
    setFailure("");
    await work().catch((cause) => setFailure(cause instanceof Error ? cause.message : `${cause}`));
    setWaiting(false);
  };

  const status = isBusy ? "Looking …" : share === 0 ? "Click the object." : `${percent(share)} of the image is marked.`;
  return (
    <dialog
      ref={dialog}
      class="mask-editor"
      aria-labelledby="mask-title"
      onKeyDown={onKeyDown}
      onCancel={(event) => {
        event.preventDefault();
        event.stopPropagation();
        on.onCancel();
      }}
    >
      <header class="row">
        <h2 id="mask-title">Mark {name}</h2>
        <Brush
          {...{ brush, width, height }}
          onBrush={(change) => setBrush((now) => ({ ...now, ...change }))}
          onCross={setCross}
          onMark={() => put({ ...brush, points: [cross] })}
          onUndo={undo}
        />
        <button type="button" id="mask-undo" disabled={marks.length === 0} onClick={undo}>
          Undo
        </button>
        <button type="button" id="mask-redo" disabled={undone.length === 0} onClick={redo}>
          Redo
        </button>
      </header>
      <Stage {...{ name, view, colour, mask, marks, cross, brush }} onCross={setCross} onMark={put} />
      <footer class="row">
        <p class="quiet" id="mask-keys">
          Click the object. Strokes add to it or remove from it; with Alt, a stroke does the other one. The wheel or two
          fingers zoom and move the photo.
          <span class="for-keys">
            {" "}
            With the focus on “Mark at the cross”: arrows move the cross, Enter marks, X changes between adding and
            removing, Backspace undoes.
          </span>
        </p>
        <p class="quiet" role="status" id="mask-status" aria-busy={isBusy}>
          {failure || status}
        </p>
        <button type="button" id="mask-cancel" onClick={on.onCancel}>
          Cancel
        </button>
        <button
          type="button"
          id="mask-done"
          class="primary"
          disabled={isBusy || share === 0}
          onClick={() => attempt(() => on.onDone(mask, marks))}
        >
          Use mask
        </button>
      </footer>
    </dialog>
  );
}
