/** Distances along the rays of a camera, as ray tracers and LiDAR write them, and depth along its optical axis. */
import type { Pinhole } from "./pinhole.js";

/**
 * The depth z of distances d from the camera's centre: z = d / √(1 + x² + y²), x = (u − cx)/fx, y = (v − cy)/fy.
 * @param distances row-major, times `scale` metres
 */
export function depthOfRays(
  distances: ArrayLike<number>,
  width: number,
  { fx, fy, cx, cy }: Pinhole,
  scale = 1,
): Float32Array {
  return Float32Array.from(distances, (distance, i) => {
    const [x, y] = [((i % width) - cx) / fx, (Math.floor(i / width) - cy) / fy];
    return (distance * scale) / Math.sqrt(1 + x * x + y * y);
  });
}
