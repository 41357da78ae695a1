/** Fills polygons. */
import { type ImageSize, MAX_PIXELS } from "../values/pixels.js";

/** A closed line: x0, y0, x1, y1, … */
export type Ring = readonly number[];

/** Longest total height of the edges, in rows, which bounds the time for malicious files. */
const MAX_ROWS = MAX_PIXELS;

/** Rows just above and below a pixel's centre, so that pixels on an edge are inside. */
const ASIDE = 1e-6;

/**
 * The pixels of areas, each of which is what an odd number of its rings encloses. Pixels have their centres at halves, as COCO
 * and LabelMe have it, or at integers where all coordinates are, as in contours of OpenCV, whose pixels are all inside.
 */
export function filledAreas(areas: readonly (readonly Ring[])[], { width, height }: ImageSize): Uint8Array {
  const pixels = new Uint8Array(width * height);
  const shift = areas.flat(2).every(Number.isInteger) ? 0 : 0.5;
  let rest = MAX_ROWS;
  for (const rings of areas) {
    for (const aside of [-ASIDE, ASIDE]) {
      const crossings: number[][] = Array.from({ length: height }, () => []);
      for (const ring of rings) {
        for (let i = 0; i < ring.length; i += 2) {
          const k = (i + 2) % ring.length;
          const [x0, y0, x1, y1] = [ring[i], ring[i + 1], ring[k], ring[k + 1]] as [number, number, number, number];
          const [low, high] = [Math.min(y0, y1), Math.max(y0, y1)].map((y) => Math.ceil(y - shift - aside)) as [
            number,
            number,
          ];
          for (let row = Math.max(low, 0); row < Math.min(high, height) && rest > 0; row++, rest--) {
            crossings[row]?.push(x0 + ((row + shift + aside - y0) / (y1 - y0)) * (x1 - x0) - shift);
          }
        }
      }
      crossings.forEach((all, row) => {
        all.sort((a, b) => a - b);
        for (let i = 0; i + 1 < all.length; i += 2) {
          const first = Math.max(0, Math.ceil((all[i] as number) - ASIDE));
          const last = Math.min(width - 1, Math.floor((all[i + 1] as number) + ASIDE));
          if (last >= first) pixels.fill(1, row * width + first, row * width + last + 1);
        }
      });
    }
  }
  return pixels;
}
