/** Small pictures of meshes and masks. */
import type { MeshArrays } from "sim3align";
import type { Rgb } from "sim3align/pictures/colours";
import { lightAt } from "sim3align/pictures/shading";
import { boundsOf } from "../state/pose.js";
import { boxOf } from "./box.js";
import { rgbOf } from "./colours.js";
import { renderDepth } from "./rasteriser.js";

/** How far a mesh is turned about its up axis and towards the viewer, radians. */
const [TURN, TILT] = [0.6, 0.35];

/** A mesh from three quarters, upright as in glTF, shaded in one colour. */
export function meshThumbnail(mesh: MeshArrays, size: number, colour: string): ImageData {
  const { centre, sides } = boundsOf(mesh);
  const radius = Math.hypot(...sides) / 2 || 1;
  const focal = 4 * size;
  // The sphere around the mesh fills the picture.
  const distance = (2.2 * focal * radius) / size;
  const [s, c, a, b] = [Math.sin(TURN), Math.cos(TURN), Math.sin(TILT), Math.cos(TILT)];
  // Rows of the rotation from the mesh (y up) to the camera (y down, z forward).
  const rows = [
    [c, 0, -s],
    [-a * s, -b, -a * c],
    [-b * s, a, -b * c],
  ] as const;
  const offset = rows.map(
    (row, i) => (i === 2 ? distance : 0) - row.reduce((sum, x, k) => sum + x * (centre[k] ?? 0), 0),
  );
  const at = (row: number, column: number) => rows[row]?.[column] ?? 0;
  const matrix = [0, 1, 2].flatMap((column) => [at(0, column), at(1, column), at(2, column), 0]);
  const camera = { fx: focal, fy: focal, cx: size / 2, cy: size / 2 };
  const depth = renderDepth(mesh, [...matrix, ...offset, 1], { width: size, height: size, camera });
  return shaded(depth, size, camera, rgbOf(colour));
}

/** A depth map, shaded by the slope of its surface, in the colours of `albedo` or its own. Transparent where there is none. */
export function shaded(
  depth: Float32Array,
  width: number,
  focal: { fx: number; fy: number },
  own: Rgb,
  albedo: (pixel: number) => Rgb | null = () => null,
): ImageData {
  const height = depth.length / width;
  const image = new ImageData(width, height);
  for (let pixel = 0; pixel < depth.length; pixel++) {
    if (depth[pixel] === 0) continue;
    const light = lightAt({ data: depth, width, height }, pixel, focal);
    const [red, green, blue] = albedo(pixel) ?? own;
    image.data.set([red * light, green * light, blue * light, 255], 4 * pixel);
  }
  return image;
}

/** A square in an image, in pixels. */
interface Square {
  u0: number;
  v0: number;
  side: number;
}

/** The square around a mask, or around the image if the mask is empty; `margin` is a multiple of the box. */
export function squareAround(mask: Uint8Array, width: number, margin: number): Square {
  const height = mask.length / width;
  const { left, top, right, bottom } = boxOf(mask, width) ?? { left: 0, top: 0, right: width, bottom: height };
  const side = margin * Math.max(right - left, bottom - top);
  return { u0: (left + right - side) / 2, v0: (top + bottom - side) / 2, side };
}

/** An image, or grey, in which everything but a mask is faded, cropped to the mask. */
export function maskThumbnail(
  rgba: Uint8ClampedArray | null,
  mask: Uint8Array,
  width: number,
  size: number,
  colour: string,
): ImageData {
  const height = mask.length / width;
  const { u0, v0, side } = squareAround(mask, width, 1.25);
  const own = rgbOf(colour);
  const image = new ImageData(size, size);
  for (let y = 0; y < size; y++) {
    for (let x = 0; x < size; x++) {
      const [u, v] = [Math.floor(u0 + ((x + 0.5) * side) / size), Math.floor(v0 + ((y + 0.5) * side) / size)];
      if (u < 0 || v < 0 || u >= width || v >= height) continue;
      const pixel = v * width + u;
      const inside = mask[pixel] !== 0;
      const mixed = own.map((part, k) => {
        const seen = rgba?.[4 * pixel + k] ?? 128;
        return inside ? 0.65 * seen + 0.35 * part : 0.3 * seen;
      });
      image.data.set([...mixed, 255], 4 * (y * size + x));
    }
  }
  return image;
}
