/** The photo with its mask, on which strokes are drawn. */
import { useEffect, useRef, useState } from "preact/hooks";
import { shareOf, wholeImage, zoomedAt } from "../pictures/zoom.js";
import type { View } from "./grid.js";
import { drawMarks } from "./marks-picture.js";
import type { Mark } from "./strokes.js";

export type Pixel = readonly [x: number, y: number];

interface StageProps {
  /** The name of the object. */
  name: string;
  view: View & { rgba: Uint8ClampedArray };
  colour: string;
  mask: Uint8Array;
  marks: readonly Mark[];
  cross: Pixel;
  brush: Omit<Mark, "points">;
  onCross(pixel: Pixel): void;
  onMark(mark: Mark): void;
}

/** A pointer event on the canvas. */
type OnCanvas = PointerEvent & { currentTarget: HTMLCanvasElement };

export function Stage({ name, view, colour, mask, marks, cross, brush, onCross, onMark }: StageProps) {
  const { width, height } = view;
  const canvas = useRef<HTMLCanvasElement>(null);
  const [drawn, setDrawn] = useState<Mark | null>(null);
  const [zoom, setZoom] = useState(wholeImage);
  /** Where the pointers that are down were last. */
  const pointers = useRef(new Map<number, Pixel>());
  useEffect(() => {
    if (canvas.current !== null) drawMarks(canvas.current, view, mask, { marks, drawn, cross, colour });
  });

  /** The pixel of the view below the pointer. */
  const pixelOf = ({ clientX, clientY, currentTarget }: OnCanvas): Pixel => {
    const box = currentTarget.getBoundingClientRect();
    const at = (share: number, end: number) => Math.min(Math.max(Math.floor(share * end), 0), end - 1);
    return [at((clientX - box.left) / box.width, width), at((clientY - box.top) / box.height, height)];
  };

  const begin = (event: OnCanvas) => {
    if (event.button > 1) return;
    event.preventDefault();
    event.currentTarget.setPointerCapture(event.pointerId);
    pointers.current.set(event.pointerId, [event.clientX, event.clientY]);
    // A second finger, or the middle button, moves the photo.
    if (pointers.current.size > 1 || event.button === 1) return setDrawn(null);
    const point = pixelOf(event);
    onCross(point);
    setDrawn({ ...brush, points: [point], adds: brush.adds !== event.altKey });
  };

  const goOn = (event: OnCanvas) => {
    const before = pointers.current.get(event.pointerId);
    if (drawn === null && before !== undefined) {
      const others = [...pointers.current].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
      pointers.current.set(event.pointerId, [event.clientX, event.clientY]);
      const [other] = others;
      const distance = ([x, y]: Pixel) => (other === undefined ? 1 : Math.hypot(x - other[0], y - other[1]) || 1);
      const factor = distance([event.clientX, event.clientY]) / distance(before);
      const share = 1 / (others.length + 1);
      const box = event.currentTarget.getBoundingClientRect();
      const [dx, dy] = [event.clientX - before[0], event.clientY - before[1]];
      return setZoom((now) => {
        const moved = { ...now, x: now.x - (share * dx) / box.width, y: now.y - (share * dy) / box.height };
        return zoomedAt(moved, factor, shareOf(box, ...(other ?? before)));
      });
    }
    if (drawn === null) return;
    const point = pixelOf(event);
    const [x, y] = drawn.points.at(-1) ?? point;
    if (Math.hypot(point[0] - x, point[1] - y) >= Math.max(1, drawn.radius / 3)) {
      setDrawn({ ...drawn, points: [...drawn.points, point] });
    }
  };

  const end = ({ pointerId }: OnCanvas) => {
    pointers.current.delete(pointerId);
    if (drawn !== null) onMark(drawn);
    setDrawn(null);
  };

  const cancel = ({ pointerId }: OnCanvas) => {
    pointers.current.delete(pointerId);
    setDrawn(null);
  };

  const wheel = (event: WheelEvent & { currentTarget: HTMLCanvasElement }) => {
    event.preventDefault();
    const box = event.currentTarget.getBoundingClientRect();
    const at = shareOf(box, event.clientX, event.clientY);
    setZoom((now) => zoomedAt(now, Math.exp(-0.0015 * event.deltaY), at));
  };

  return (
    <div class="mask-stage">
      <canvas
        ref={canvas}
        class="picture"
        width={width}
        height={height}
        style={{ "--ratio": width / height, "--zoom": zoom.factor, "--x": zoom.x, "--y": zoom.y }}
        role="img"
        aria-label={`Photo with the mask of ${name}`}
        onPointerDown={begin}
        onPointerMove={goOn}
        onPointerUp={end}
        onPointerCancel={cancel}
        onWheel={wheel}
      />
    </div>
  );
}
