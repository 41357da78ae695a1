/** What was marked on a photo: clicks and strokes, one after the other. */

/** A click or a stroke of the brush. */
export interface Stroke {
  /** In pixels; one point is a click. */
  points: readonly (readonly [x: number, y: number])[];
  /** Of the brush, pixels. */
  radius: number;
  /** Whether it is on the object, or on what is not the object. */
  adds: boolean;
}

/** A stroke as it was made. */
export interface Mark extends Stroke {
  /** Whether it selects what is like it, up to the edges; otherwise it paints what it covers. */
  followsEdges: boolean;
}

/** A mask on which marks paint, except those that select up to edges; null is an empty one. */
export function painted(
  marks: readonly Mark[],
  before: Uint8Array | null,
  { width, height }: { width: number; height: number },
): Uint8Array {
  const mask = Uint8Array.from(before ?? new Uint8Array(width * height));
  for (const mark of marks) {
    if (!mark.followsEdges || !mark.adds)
      eachCovered(mark, width, height, (pixel) => {
        mask[pixel] = mark.adds ? 1 : 0;
      });
  }
  return mask;
}

/** Calls `use` for each pixel that a stroke covers, at least that of its first point. */
export function eachCovered(
  { points, radius }: Pick<Stroke, "points" | "radius">,
  width: number,
  height: number,
  use: (pixel: number) => void,
): void {
  // A brush of less than a pixel still covers the one that it is on.
  const reach = Math.max(radius, Math.SQRT1_2);
  points.forEach((to, k) => {
    const from = points[Math.max(0, k - 1)] as readonly [number, number];
    const range = (i: 0 | 1, end: number) => [
      Math.max(0, Math.ceil(Math.min(from[i], to[i]) - reach)),
      Math.min(end - 1, Math.floor(Math.max(from[i], to[i]) + reach)),
    ];
    const [[left = 0, right = 0], [top = 0, bottom = 0]] = [range(0, width), range(1, height)];
    for (let y = top; y <= bottom; y++) {
      for (let x = left; x <= right; x++) if (toSegment(x, y, from, to) <= reach) use(y * width + x);
    }
  });
}

type Point = readonly [x: number, y: number];

/** The distance from a point to a segment. */
function toSegment(x: number, y: number, [x0, y0]: Point, [x1, y1]: Point): number {
  const [dx, dy] = [x1 - x0, y1 - y0];
  const length = dx * dx + dy * dy;
  const t = length === 0 ? 0 : Math.min(1, Math.max(0, ((x - x0) * dx + (y - y0) * dy) / length));
  return Math.hypot(x - x0 - t * dx, y - y0 - t * dy);
}
