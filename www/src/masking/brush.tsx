/** The brush: its controls, and the button that marks at the cross, which keys move. */
import { Check } from "../ui/controls.js";
import type { Pixel } from "./stage.js";
import type { Mark } from "./strokes.js";

export type BrushSettings = Omit<Mark, "points">;

/** Radii of the brush, in shares of the longer side. */
const [THINNEST, FIRST, THICKEST] = [0.002, 0.01, 0.08];

/** Steps of the cross that the arrow keys move, in shares of the longer side. */
const [STEP, LONG_STEP] = [0.005, 0.05];

export const firstBrush = (longest: number): BrushSettings => ({
  radius: FIRST * longest,
  adds: true,
  followsEdges: true,
});

interface BrushProps {
  brush: BrushSettings;
  /** Of the image, pixels. */
  width: number;
  height: number;
  onBrush(change: Partial<BrushSettings>): void;
  onCross(move: (cross: Pixel) => Pixel): void;
  onMark(): void;
  onUndo(): void;
}

export function Brush({ brush, width, height, onBrush, onCross, onMark, onUndo }: BrushProps) {
  const { adds, followsEdges, radius } = brush;
  const longest = Math.max(width, height);

  const keys = (event: KeyboardEvent) => {
    const step = (event.shiftKey ? LONG_STEP : STEP) * longest;
    const by = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] }[event.key];
    if (by !== undefined) {
      const [dx = 0, dy = 0] = by;
      const within = (value: number, most: number) => Math.round(Math.min(Math.max(value, 0), most - 1));
      onCross(([x, y]) => [within(x + dx, width), within(y + dy, height)]);
    } else if (event.key === "Backspace") onUndo();
    else if (event.key === "x") onBrush({ adds: !adds });
    else return;
    event.preventDefault();
    // Keys of the page do other things.
    event.stopPropagation();
  };

  return (
    <>
      <fieldset class="row">
        <legend class="visually-hidden">Brush</legend>
        {[true, false].map((value) => (
          <label key={`${value}`} class="check">
            <input type="radio" name="mask-brush" checked={adds === value} onChange={() => onBrush({ adds: value })} />
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
          onInput={({ currentTarget }) => onBrush({ radius: currentTarget.valueAsNumber })}
        />
      </label>
      <Check
        id="mask-edges"
        title="Follow edges"
        checked={followsEdges}
        onCheck={(checked) => onBrush({ followsEdges: checked })}
      />
      <button type="button" id="mask-here" aria-describedby="mask-keys" onKeyDown={keys} onClick={onMark}>
        Mark at the cross
      </button>
    </>
  );
}
