/** The colours of a mesh in a small picture, from the coloured points of its surface. */
import type { MeshArrays } from "sim3align";
import type { Rgb } from "sim3align/pictures/colours";
import type { Scene } from "../state/scene.js";
import { projected } from "./rasteriser.js";

/** A point is seen if it is at most this much behind what is drawn, as a share of its distance. */
const BEHIND = 0.01;
/** Pixels between points take the colour of a neighbour at most this far away. */
const NEAR_PX = 3;

/**
 * The colour of each pixel of a square picture, or null where no coloured point is near.
 * @param matrix camera from mesh, 16 numbers, column-major
 * @param depth of the drawn mesh, metres, 0 where there is none
 */
export function albedoOf(
  { samples }: MeshArrays,
  matrix: ArrayLike<number>,
  depth: Float32Array,
  size: number,
  camera: Scene["camera"],
): (pixel: number) => Rgb | null {
  if (samples == null) return () => null;
  const { positions, colors } = samples;
  const points = projected(positions, matrix, camera);
  const sums = new Float32Array(4 * depth.length);
  for (let i = 0; i + 2 < positions.length; i += 3) {
    const [u, v] = [Math.round(points[i] as number), Math.round(points[i + 1] as number)];
    const z = 1 / (points[i + 2] as number);
    if (!Number.isFinite(z) || u < 0 || v < 0 || u >= size || v >= size) continue;
    const pixel = v * size + u;
    const drawn = depth[pixel] as number;
    if (drawn === 0 || z > drawn * (1 + BEHIND)) continue;
    for (let k = 0; k < 3; k++) sums[4 * pixel + k] = (sums[4 * pixel + k] as number) + (colors[i + k] as number);
    sums[4 * pixel + 3] = (sums[4 * pixel + 3] as number) + 1;
  }
  const mean = (pixel: number): Rgb | null => {
    const count = sums[4 * pixel + 3] ?? 0;
    if (count === 0) return null;
    return [0, 1, 2].map((k) => (sums[4 * pixel + k] as number) / count) as unknown as Rgb;
  };
  return (pixel) => {
    const [column, row] = [pixel % size, Math.floor(pixel / size)];
    for (let r = 0; r <= NEAR_PX; r++) {
      for (let v = Math.max(0, row - r); v <= Math.min(size - 1, row + r); v++) {
        for (let u = Math.max(0, column - r); u <= Math.min(size - 1, column + r); u++) {
          if (Math.max(Math.abs(u - column), Math.abs(v - row)) !== r) continue;
          const found = mean(v * size + u);
          if (found !== null) return found;
        }
      }
    }
    return null;
  };
}
