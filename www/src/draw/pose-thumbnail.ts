/** A small picture of a mesh at a pose, in the image that it was seen in. */
import type { MeshArrays } from "sim3align";
import { type Rgb, rgbOf } from "./colours.js";
import { renderDepth } from "./rasteriser.js";
import { shaded } from "./thumbnails.js";

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
  const { u0, v0, side } = square(mask, width, height);
  const zoom = size / side;
  const lens = {
    ...{ fx: camera.fx * zoom, fy: camera.fy * zoom },
    ...{ cx: (camera.cx + 0.5 - u0) * zoom - 0.5, cy: (camera.cy + 0.5 - v0) * zoom - 0.5 },
  };
  const depth = renderDepth(mesh, matrix, { width: size, height: size, camera: lens });
  const drawn = shaded(depth, size, lens, rgbOf(colour) as Rgb);
  for (let y = 0; y < size; y++) {
    for (let x = 0; x < size; x++) {
      const at = 4 * (y * size + x);
      const [u, v] = [Math.floor(u0 + (x + 0.5) / zoom), Math.floor(v0 + (y + 0.5) / zoom)];
      const inside = u >= 0 && v >= 0 && u < width && v < height;
      const isMesh = (drawn.data[at + 3] ?? 0) > 0;
      for (let k = 0; k < 3; k++) {
        const seen = inside ? (rgba[4 * (v * width + u) + k] ?? 0) : 0;
        drawn.data[at + k] = isMesh ? 0.75 * (drawn.data[at + k] ?? 0) + 0.25 * seen : seen;
      }
      drawn.data[at + 3] = 255;
    }
  }
  return drawn;
}

/** The square around a mask, in pixels. */
function square(mask: Uint8Array, width: number, height: number): { u0: number; v0: number; side: number } {
  let [left, top, right, bottom] = [width, height, 0, 0];
  mask.forEach((inside, pixel) => {
    if (inside === 0) return;
    const [u, v] = [pixel % width, Math.floor(pixel / width)];
    [left, right] = [Math.min(left, u), Math.max(right, u)];
    [top, bottom] = [Math.min(top, v), Math.max(bottom, v)];
  });
  if (right < left) return { u0: 0, v0: 0, side: Math.min(width, height) };
  const side = MARGIN * Math.max(right - left + 1, bottom - top + 1);
  return { u0: (left + right + 1 - side) / 2, v0: (top + bottom + 1 - side) / 2, side };
}
