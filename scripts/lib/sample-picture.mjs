/** Small pictures of the page's samples: the photo, or the shaded depth map with its objects in colour. */
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { packageDir } from "./paths.mjs";
import { rgbPng } from "./png.mjs";

/** Pixels of the images per pixel of the picture. */
const REDUCTION = 4;

/** Colours of the objects, red, green and blue. */
const colours = [
  [240, 138, 36],
  [60, 158, 229],
  [47, 163, 107],
];

/** @typedef {{ data: ArrayLike<number>, width: number, height: number }} Pixels */

/**
 * The picture of a sample as a PNG.
 * @param {string} folder of all samples
 * @param {import("./sample.mjs").Sample} sample
 */
export async function pictureOf(folder, { depth, camera, photo, objects }) {
  const formats = await import(pathToFileURL(join(packageDir, "formats.js")).href);
  const file = (/** @type {string} */ path) => Uint8Array.from(readFileSync(join(folder, path)));
  const rgb =
    photo === undefined
      ? shaded(
          await formats.readDepth(file(depth), { depthScale: JSON.parse(`${Buffer.from(file(camera))}`).depthScale }),
          await Promise.all(objects.map(({ mask }) => formats.readMask(file(mask)))),
        )
      : await formats.readImage(file(photo));
  return png(reduced(rgb));
}

/**
 * A depth map, lit from the upper left, with each object in its colour.
 * @param {Pixels} depth
 * @param {readonly Pixels[]} masks
 * @returns {Pixels}
 */
function shaded({ data, width, height }, masks) {
  const rgb = new Uint8Array(3 * width * height);
  const at = (/** @type {number} */ u, /** @type {number} */ v) =>
    data[Math.min(Math.max(v, 0), height - 1) * width + Math.min(Math.max(u, 0), width - 1)] || 0;
  for (let i = 0; i < width * height; i++) {
    const [u, v] = [i % width, Math.floor(i / width)];
    const z = at(u, v);
    if (z === 0) continue;
    // Slopes over some pixels, because the depth is noisy.
    const slope = (/** @type {number} */ a, /** @type {number} */ b) => (((b || z) - (a || z)) / (8 * z)) * width;
    const [dx, dy] = [slope(at(u - 4, v), at(u + 4, v)), slope(at(u, v - 4), at(u, v + 4))];
    const light = 0.42 + 0.62 * Math.max(0, (0.45 * dx + 0.55 * dy + 0.7) / Math.hypot(dx, dy, 1));
    const object = masks.findIndex((mask) => mask.data[i] !== 0);
    const colour = colours[object % colours.length] ?? [158, 168, 182];
    colour.forEach((part, k) => {
      rgb[3 * i + k] = Math.min(255, part * light);
    });
  }
  return { data: rgb, width, height };
}

/**
 * Means over squares of pixels.
 * @param {Pixels} image
 * @returns {Pixels}
 */
function reduced({ data, width, height }) {
  const [w, h] = [Math.floor(width / REDUCTION), Math.floor(height / REDUCTION)];
  const rgb = new Uint8Array(3 * w * h);
  for (let i = 0; i < rgb.length; i++) {
    const [k, u, v] = [i % 3, Math.floor(i / 3) % w, Math.floor(i / 3 / w)];
    let sum = 0;
    for (let j = 0; j < REDUCTION * REDUCTION; j++) {
      const [x, y] = [REDUCTION * u + (j % REDUCTION), REDUCTION * v + Math.floor(j / REDUCTION)];
      sum += data[3 * (y * width + x) + k] ?? 0;
    }
    rgb[i] = Math.round(sum / (REDUCTION * REDUCTION));
  }
  return { data: rgb, width: w, height: h };
}

/**
 * An 8-bit RGB PNG.
 * @param {Pixels} image
 */
function png({ data, width, height }) {
  const rows = Buffer.alloc(height * (1 + 3 * width));
  for (let v = 0; v < height; v++) {
    // Each byte as its difference from the pixel on the left, which compresses better.
    rows[v * (1 + 3 * width)] = 1;
    for (let x = 0; x < 3 * width; x++) {
      const left = x < 3 ? 0 : (data[3 * v * width + x - 3] ?? 0);
      rows[v * (1 + 3 * width) + 1 + x] = (data[3 * v * width + x] ?? 0) - left;
    }
  }
  return rgbPng(rows, width, height, 9);
}
