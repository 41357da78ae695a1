/** What is under the pointer: of the points, by projecting all of them. No three.js here: numbers only. */

/** By which share of its distance a point at the end of the reach has to be nearer than one right under the pointer. */
const beside = 0.1;

/** A point under the pointer. */
export interface Hit {
  /** Which of the points. */
  index: number;
  /** How far away, in clip space's w: metres along the line of sight. */
  distance: number;
}

/**
 * The nearest of the points that are within some pixels of a place on the screen.
 *
 * @param positions x, y, z per point
 * @param clip clip space from the points' frame, column by column
 * @param at where, pixels from the left and top
 * @param size of the screen, pixels
 * @param reachPx how far beside it a point may be
 */
export function pickPoint(
  positions: Float32Array,
  clip: ArrayLike<number>,
  at: { x: number; y: number },
  size: { width: number; height: number },
  reachPx: number,
): Hit | null {
  const row = (i: number) => [clip[i] ?? 0, clip[i + 4] ?? 0, clip[i + 8] ?? 0, clip[i + 12] ?? 0] as const;
  const [ax, ay, az, aw] = row(0);
  const [bx, by, bz, bw] = row(1);
  const [dx, dy, dz, dw] = row(3);
  const wantedX = (2 * at.x) / size.width - 1;
  const wantedY = 1 - (2 * at.y) / size.height;
  const [reachX, reachY] = [(2 * reachPx) / size.width, (2 * reachPx) / size.height];
  let best: Hit | null = null;
  let least = Number.POSITIVE_INFINITY;
  for (let i = 0; i < positions.length; i += 3) {
    const [x, y, z] = [positions[i] as number, positions[i + 1] as number, positions[i + 2] as number];
    const w = dx * x + dy * y + dz * z + dw;
    if (w <= 0 || w >= least) continue;
    const [offX, offY] = [(ax * x + ay * y + az * z + aw) / w - wantedX, (bx * x + by * y + bz * z + bw) / w - wantedY];
    const off = Math.max(Math.abs(offX) / reachX, Math.abs(offY) / reachY);
    // Of a surface, the point that is closest to the pointer: what is beside it has to be clearly nearer.
    const cost = w * (1 + beside * off);
    if (off > 1 || cost >= least) continue;
    least = cost;
    best = { index: i / 3, distance: w };
  }
  return best;
}

/**
 * The pixel that a point of the OpenCV camera frame is seen at; `null` behind the camera or outside the image.
 */
export function pixelOf(
  [x, y, z]: readonly [number, number, number],
  {
    camera,
    width,
    height,
  }: { camera: { fx: number; fy: number; cx: number; cy: number }; width: number; height: number },
): { x: number; y: number } | null {
  if (!(z > 0)) return null;
  // Without −0.
  const [u, v] = [Math.round((camera.fx * x) / z + camera.cx) + 0, Math.round((camera.fy * y) / z + camera.cy) + 0];
  return u >= 0 && v >= 0 && u < width && v < height ? { x: u, y: v } : null;
}
