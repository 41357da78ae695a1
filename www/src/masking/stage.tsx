/** The photo with its mask, on which strokes are drawn. */
import { useEffect, useRef, useState } from "preact/hooks";
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
    if (event.button !== 0) return;
    event.currentTarget.setPointerCapture(event.pointerId);
    const point = pixelOf(event);
    onCross(point);
    setDrawn({ ...brush, points: [point], adds: brush.adds !== event.altKey });
  };

  const goOn = (event: OnCanvas) => {
    if (drawn === null) return;
    const point = pixelOf(event);
    const [x, y] = drawn.points.at(-1) ?? point;
    if (Math.hypot(point[0] - x, point[1] - y) >= Math.max(1, drawn.radius / 3)) {
      setDrawn({ ...drawn, points: [...drawn.points, point] });
    }
  };

  const end = () => {
    if (drawn !== null) onMark(drawn);
    setDrawn(null);
  };

  return (
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
  );
}
