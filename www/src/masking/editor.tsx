/** The mask tool: clicks and strokes of a brush on the photo. */
import { useEffect, useRef, useState } from "preact/hooks";
import { Check } from "../ui/controls.js";
import { percent } from "../ui/texts.js";
import { Finder } from "./finder.js";
import type { View } from "./grid.js";
import { drawMarks } from "./marks-picture.js";
import type { PhotoModel } from "./photo-model.js";
import { type Mark, painted } from "./strokes.js";

interface EditorProps {
  /** The name of the object. */
  name: string;
  view: View & { rgba: Uint8ClampedArray };
  colour: string;
  /** A mask that is there already, at the size of the view. */
  before: Uint8Array | null;
  /** The marks of a mask that was made here. */
  marks: readonly Mark[];
  /** The models of the host, if there is a photo for them. */
  model: PhotoModel | undefined;
  onDone(mask: Uint8Array, marks: readonly Mark[]): Promise<void>;
  /** Asks the model about the object at this place. */
  onAsk(place: readonly [number, number]): Promise<void>;
  onCancel(): void;
}

/** Radii of the brush, in shares of the longer side. */
const [THINNEST, FIRST, THICKEST] = [0.002, 0.01, 0.08];

/** Steps of the cross that the arrow keys move, in shares of the longer side. */
const [STEP, LONG_STEP] = [0.005, 0.05];

export function MaskEditor({ name, view, colour, before, marks: first, model, ...on }: EditorProps) {
  const { width, height } = view;
  const longest = Math.max(width, height);
  const dialog = useRef<HTMLDialogElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const keyboard = useRef<HTMLButtonElement>(null);
  const finder = useRef<Finder | null>(null);
  const [marks, setMarks] = useState(first);
  const [region, setRegion] = useState<Uint8Array | null>(null);
  const [isBusy, setBusy] = useState(false);
  const [adds, setAdds] = useState(true);
  const [followsEdges, setFollows] = useState(true);
  const [radius, setRadius] = useState(FIRST * longest);
  const [cross, setCross] = useState<readonly [number, number]>([Math.round(width / 2), Math.round(height / 2)]);
  const [drawn, setDrawn] = useState<Mark | null>(null);
  const [failure, setFailure] = useState("");

  useEffect(() => {
    if (dialog.current?.open === false) dialog.current.showModal();
    keyboard.current?.focus();
    finder.current = new Finder({ ...view }, (found) => {
      setRegion(found);
      setBusy(false);
    });
    return () => finder.current?.stop();
  }, [view]);

  const edges = marks.filter((mark) => mark.followsEdges);
  const hasRegion = edges.some((mark) => mark.adds);
  const asked = JSON.stringify(edges);
  useEffect(() => {
    if (!hasRegion) return setRegion(null);
    setBusy(true);
    finder.current?.find(edges);
  }, [asked]);

  const mask = painted(marks, hasRegion ? region : null, before, view);
  const share = mask.reduce((sum, inside) => sum + inside, 0) / mask.length;
  useEffect(() => {
    if (canvas.current !== null) drawMarks(canvas.current, view, mask, { marks, drawn, cross, colour });
  });

  const put = (mark: Mark) => setMarks((now) => [...now, mark]);
  const undo = () => setMarks((now) => now.slice(0, -1));
  const lastAdded = marks
    .filter((mark) => mark.adds)
    .at(-1)
    ?.points.at(-1);

  /** The pixel of the view below the pointer. */
  const pixelOf = ({
    clientX,
    clientY,
    currentTarget,
  }: {
    clientX: number;
    clientY: number;
    currentTarget: Element;
  }) => {
    const box = currentTarget.getBoundingClientRect();
    const at = (share: number, end: number) => Math.min(Math.max(Math.floor(share * end), 0), end - 1);
    return [at((clientX - box.left) / box.width, width), at((clientY - box.top) / box.height, height)] as const;
  };
  const begin = (event: PointerEvent & { currentTarget: HTMLCanvasElement }) => {
    if (event.button !== 0) return;
    event.currentTarget.setPointerCapture(event.pointerId);
    const point = pixelOf(event);
    setCross(point);
    setDrawn({ points: [point], radius, adds: adds !== event.altKey, followsEdges });
  };
  const goOn = (event: PointerEvent & { currentTarget: HTMLCanvasElement }) => {
    if (drawn === null) return;
    const point = pixelOf(event);
    const [x, y] = drawn.points.at(-1) ?? point;
    if (Math.hypot(point[0] - x, point[1] - y) >= Math.max(1, radius / 3)) {
      setDrawn({ ...drawn, points: [...drawn.points, point] });
    }
  };
  const end = () => {
    if (drawn !== null) put(drawn);
    setDrawn(null);
  };

  const keys = (event: KeyboardEvent) => {
    const step = (event.shiftKey ? LONG_STEP : STEP) * longest;
    const by = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] }[event.key];
    if (by !== undefined) {
      const [dx = 0, dy = 0] = by;
      const within = (value: number, most: number) => Math.round(Math.min(Math.max(value, 0), most - 1));
      setCross(([x, y]) => [within(x + dx, width), within(y + dy, height)]);
    } else if (event.key === "Backspace" || (event.key === "z" && (event.ctrlKey || event.metaKey))) undo();
    else if (event.key === "x") setAdds(!adds);
    else return;
    event.preventDefault();
    // Keys of the page do other things.
    event.stopPropagation();
  };

  const attempt = async (work: () => Promise<void>) => {
    setBusy(true);
    setFailure("");
    await work().catch((cause) => setFailure(cause instanceof Error ? cause.message : `${cause}`));
    setBusy(false);
  };
  const said = isBusy ? "Looking …" : share === 0 ? "Click the object." : `${percent(share)} of the image is marked.`;
  return (
    <dialog
      ref={dialog}
      class="mask-editor"
      aria-labelledby="mask-title"
      onCancel={(event) => {
        event.preventDefault();
        event.stopPropagation();
        on.onCancel();
      }}
    >
      <header>
        <h2 id="mask-title">Mark {name}</h2>
        <fieldset class="row">
          <legend class="visually-hidden">Brush</legend>
          {[true, false].map((value) => (
            <label key={`${value}`} class="check">
              <input type="radio" name="mask-brush" checked={adds === value} onChange={() => setAdds(value)} />
              <span>{value ? "Add" : "Remove"}</span>
            </label>
          ))}
        </fieldset>
        <label class="field-inline">
          <span>Size</span>
          <input
            id="mask-size"
            type="range"
            min={THINNEST * longest}
            max={THICKEST * longest}
            step="any"
            value={radius}
            onInput={({ currentTarget }) => setRadius(currentTarget.valueAsNumber)}
          />
        </label>
        <Check id="mask-edges" title="Follow edges" checked={followsEdges} onCheck={setFollows} />
        <button
          ref={keyboard}
          type="button"
          id="mask-here"
          aria-describedby="mask-keys"
          onKeyDown={keys}
          onClick={() => put({ points: [cross], radius, adds, followsEdges })}
        >
          Mark at the cross
        </button>
        <button type="button" id="mask-undo" disabled={marks.length === 0} onClick={undo}>
          Undo
        </button>
      </header>
      <div class="mask-stage">
        <canvas
          ref={canvas}
          width={width}
          height={height}
          style={{ "--ratio": width / height }}
          role="img"
          aria-label={`Photo with the mask of ${name}`}
          onPointerDown={begin}
          onPointerMove={goOn}
          onPointerUp={end}
          onPointerCancel={() => setDrawn(null)}
        />
      </div>
      <footer>
        <p class="quiet" id="mask-keys">
          Click the object; strokes add to it or remove from it, and Alt turns the brush around. On the button of the
          cross, arrows move it, Enter marks, X changes the brush, and Backspace takes back.
        </p>
        <p class="quiet" role="status" id="mask-status" aria-busy={isBusy}>
          {failure || said}
        </p>
        {model !== undefined && (
          <button
            type="button"
            id="mask-ask"
            disabled={isBusy || lastAdded === undefined}
            onClick={() =>
              lastAdded && attempt(() => on.onAsk([(lastAdded[0] + 0.5) / width, (lastAdded[1] + 0.5) / height]))
            }
          >
            Use {model.title}
          </button>
        )}
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
