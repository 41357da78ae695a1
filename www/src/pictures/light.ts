/** The light on an object in the photo. */
import { lightOf } from "sim3align/input/colors";
import type { Rgb } from "sim3align/pictures/colours";
import type { ObjectModel } from "../state/object-model.js";
import { rgbOf } from "./colours.js";
import { projected, renderDepth } from "./rasteriser.js";
import type { DrawnScene } from "./reduced.js";

/** A point is seen if it is at most this much behind what is drawn, and what was measured, as a share of its distance. */
const [BEHIND_MESH, BEHIND_DEPTH] = [0.01, 0.03];
/** Fewer points say nothing. */
const LEAST_POINTS = 40;
/** Photos that are far darker or brighter than this have other causes. */
const [DARKEST, BRIGHTEST] = [0.35, 2.5];

/** The linear light of sRGB bytes. */
const linear = Float32Array.from({ length: 256 }, (_, byte) => lightOf(byte / 255));

/** What a mesh is drawn in: one colour, colours of its vertices, which glTF has linear, or those of textures. */
export type Colouring = "plain" | "vertices" | "textures";

/**
 * How much brighter the photo shows an object than its own colours are: the ratio of both for what is seen of it, by channels of
 * linear light. Null where there is no photo. A mesh in one colour gets that of the photo.
 */
export function lightOn(
  view: DrawnScene,
  { colour, mesh }: ObjectModel,
  matrix: ArrayLike<number>,
  colouring: Colouring,
): Rgb | null {
  const { camera, depthM, height, rgba, width } = view;
  if (rgba === null) return null;
  const { positions, colors } = mesh.samples ?? { positions: mesh.positions, colors: null };
  if (colors === null && colouring !== "plain") return null;
  const depth = renderDepth(mesh, matrix, view);
  const points = projected(positions, matrix, camera);
  const plain = rgbOf(colour);
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
      const byte = (colouring === "plain" ? plain[k] : colors?.[i + k]) ?? 0;
      seen[k] = (seen[k] as number) + (linear[rgba[4 * pixel + k] as number] as number);
      own[k] = (own[k] as number) + (colouring === "vertices" ? byte / 255 : (linear[byte] as number));
    }
  }
  if (count < LEAST_POINTS) return null;
  return [0, 1, 2].map((k) => {
    const ratio = (seen[k] as number) / Math.max(own[k] as number, 1e-3 * count);
    return colouring === "plain" ? ratio : Math.min(Math.max(ratio, DARKEST), BRIGHTEST);
  }) as unknown as Rgb;
}
