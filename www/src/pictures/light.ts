/** The light on an object in the photo. */
import type { MeshArrays } from "sim3align";
import type { Rgb } from "sim3align/pictures/colours";
import { projected, renderDepth } from "./rasteriser.js";
import type { DrawnScene } from "./reduced.js";

/** A point is seen if it is at most this much behind what is drawn, and what was measured, as a share of its distance. */
const [BEHIND_MESH, BEHIND_DEPTH] = [0.01, 0.03];
/** Fewer points say nothing. */
const LEAST_POINTS = 40;
/** Photos that are far darker or brighter than this have other causes. */
const [DARKEST, BRIGHTEST] = [0.35, 2.5];

/** Of the bytes of sRGB, the light that they stand for. */
const linear = Float32Array.from({ length: 256 }, (_, i) =>
  i / 255 <= 0.04045 ? i / 255 / 12.92 : ((i / 255 + 0.055) / 1.055) ** 2.4,
);

/**
 * How much brighter the photo shows an object than its own colours are: the ratio of both for what is seen of it, by channels of
 * linear light; null where there is no photo, or the mesh has no colours.
 * @param isLinear whether the colours are shown as linear ones
 */
export function lightOn(view: DrawnScene, mesh: MeshArrays, matrix: ArrayLike<number>, isLinear: boolean): Rgb | null {
  const { camera, depthM, height, rgba, width } = view;
  const { samples } = mesh;
  if (rgba === null || samples == null) return null;
  const { positions, colors } = samples;
  const depth = renderDepth(mesh, matrix, view);
  const points = projected(positions, matrix, camera);
  const [seen, own] = [new Float64Array(3), new Float64Array(3)];
  let count = 0;
  for (let i = 0; i + 2 < positions.length; i += 3) {
    const [u, v] = [Math.round(points[i] as number), Math.round(points[i + 1] as number)];
    const z = 1 / (points[i + 2] as number);
    if (!(u >= 0 && v >= 0 && u < width && v < height)) continue;
    const pixel = v * width + u;
    const [drawn, measured] = [depth[pixel] as number, depthM[pixel] as number];
    const isHidden = z > drawn * (1 + BEHIND_MESH) || z > measured * (1 + BEHIND_DEPTH);
    if (drawn === 0 || isHidden) continue;
    count++;
    for (let k = 0; k < 3; k++) {
      seen[k] = (seen[k] as number) + (linear[rgba[4 * pixel + k] as number] as number);
      const colour = colors[i + k] as number;
      own[k] = (own[k] as number) + (isLinear ? colour / 255 : (linear[colour] as number));
    }
  }
  if (count < LEAST_POINTS) return null;
  return [0, 1, 2].map((k) => {
    const ratio = (seen[k] as number) / Math.max(own[k] as number, 1e-3 * count);
    return Math.min(Math.max(ratio, DARKEST), BRIGHTEST);
  }) as unknown as Rgb;
}
