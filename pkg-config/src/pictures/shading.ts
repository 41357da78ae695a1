/** Shading of depth maps of meshes: the light on their surface, and their outline. */

/** Towards the viewer, from above and from the left: where the light comes from. */
const LIGHT = [-0.4, -0.6, -0.69] as const;

/** An image of numbers, row by row; 0 is outside. */
export interface Shape {
  data: ArrayLike<number>;
  width: number;
  height: number;
}

/** The light at a pixel of a depth map, by the slope of its surface, as a factor of its colour. */
export function lightAt({ data, width, height }: Shape, i: number, { fx, fy }: { fx: number; fy: number }): number {
  const z = data[i] as number;
  const [u, v] = [i % width, Math.floor(i / width)];
  const slope = (before: number, after: number, focal: number) =>
    (((data[after] || z) - (data[before] || z)) * focal) / (2 * z);
  const dx = slope(u > 0 ? i - 1 : i, u + 1 < width ? i + 1 : i, fx);
  const dy = slope(v > 0 ? i - width : i, v + 1 < height ? i + width : i, fy);
  // The normal of the surface, towards the viewer.
  const lambert = (dx * LIGHT[0] + dy * LIGHT[1] - LIGHT[2]) / Math.hypot(dx, dy, 1);
  return 0.35 + 0.75 * Math.max(0, lambert);
}

/** Tests whether a pixel of a shape is at most `thickness` pixels from its outside. */
export function outlineOf({ data, width, height }: Shape, thickness: number): (i: number) => boolean {
  const isOutside = (u: number, v: number) => u < 0 || v < 0 || u >= width || v >= height || !data[v * width + u];
  return (i) => {
    if (!data[i]) return false;
    const [u, v] = [i % width, Math.floor(i / width)];
    for (let d = 1; d <= thickness; d++) {
      if (isOutside(u - d, v) || isOutside(u + d, v) || isOutside(u, v - d) || isOutside(u, v + d)) return true;
    }
    return false;
  };
}
