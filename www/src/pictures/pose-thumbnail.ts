/** A small picture of a mesh at a pose, in the image that it was seen in. */
import type { MeshArrays } from "sim3align";
import { albedoOf } from "./albedo.js";
import { rgbOf } from "./colours.js";
import { renderDepth } from "./rasteriser.js";
import { shaded, squareAround } from "./thumbnails.js";

/** What the picture shows. */
export interface PoseThumbnail {
  mesh: MeshArrays;
  /** Camera from mesh, column-major. */
  matrix: ArrayLike<number>;
  mask: Uint8Array;
  colour: string;
}

interface Ground {
  rgba: Uint8ClampedArray;
  width: number;
  height: number;
  camera: { fx: number; fy: number; cx: number; cy: number };
}

/** How much of the image around the mask is shown, as a multiple of its box. */
const MARGIN = 1.5;

/** The mesh, shaded, over the image around the mask. */
export function poseThumbnail({ mesh, matrix, mask, colour }: PoseThumbnail, ground: Ground, size: number): ImageData {
  const { rgba, width, height, camera } = ground;
  const { u0, v0, side } = squareAround(mask, width, MARGIN);
  const zoom = size / side;
  const lens = {
    ...{ fx: camera.fx * zoom, fy: camera.fy * zoom },
    ...{ cx: (camera.cx + 0.5 - u0) * zoom - 0.5, cy: (camera.cy + 0.5 - v0) * zoom - 0.5 },
  };
  const depth = renderDepth(mesh, matrix, { width: size, height: size, camera: lens });
  const drawn = shaded(depth, size, lens, rgbOf(colour), albedoOf(mesh, matrix, depth, size, lens));
  for (let y = 0; y < size; y++) {
    for (let x = 0; x < size; x++) {
      const at = 4 * (y * size + x);
      const [u, v] = [Math.floor(u0 + (x + 0.5) / zoom), Math.floor(v0 + (y + 0.5) / zoom)];
      const inside = u >= 0 && v >= 0 && u < width && v < height;
      const isMesh = (drawn.data[at + 3] ?? 0) > 0;
      for (let k = 0; k < 3; k++) {
        const seen = inside ? (rgba[4 * (v * width + u) + k] ?? 0) : 0;
        drawn.data[at + k] = isMesh ? 0.85 * (drawn.data[at + k] ?? 0) + 0.15 * seen : seen;
      }
      drawn.data[at + 3] = 255;
    }
  }
  return drawn;
}
