/** A part of a photo and its depth on a coarser grid. */
import type { InverseDepth } from "./support.js";

/** A photo, its depth if there is one, row-major. */
export interface View {
  width: number;
  height: number;
  /** Red, green, blue, alpha. */
  rgba: ArrayLike<number>;
  /** In any unit; 0 is no reading. */
  depth: Float32Array | null;
}

/** A rectangle in pixels of the view. */
export interface Box {
  left: number;
  top: number;
  width: number;
  height: number;
}

export interface Grid {
  box: Box;
  /** Pixels of the view per cell. */
  cell: number;
  width: number;
  height: number;
  /** Brightness and two differences of colours per cell, each 0 to about 255. */
  colours: Float64Array;
  inverse: InverseDepth | null;
}

/** A part of a view with at most `most` cells along its longer side; cells are means of colours and medians of depth. */
export function gridOf({ rgba, depth, width: across, height: down }: View, box: Box, most: number): Grid {
  const cell = Math.max(1, Math.max(box.width, box.height) / most);
  const [width, height] = [Math.max(1, Math.round(box.width / cell)), Math.max(1, Math.round(box.height / cell))];
  const colours = new Float64Array(3 * width * height);
  const inverse = depth === null ? null : { data: new Float64Array(width * height), width, height };
  const from = (k: number, start: number, end: number) => Math.min(end - 1, Math.max(0, Math.floor(start + k * cell)));
  const readings: number[] = [];
  for (let y = 0; y < height; y++) {
    const [top, bottom] = [from(y, box.top, down), Math.max(from(y, box.top, down) + 1, from(y + 1, box.top, down))];
    for (let x = 0; x < width; x++) {
      const left = from(x, box.left, across);
      const right = Math.max(left + 1, from(x + 1, box.left, across));
      let [r, g, b] = [0, 0, 0];
      readings.length = 0;
      for (let v = top; v < bottom; v++) {
        for (let u = left; u < right; u++) {
          const i = v * across + u;
          r += rgba[4 * i] as number;
          g += rgba[4 * i + 1] as number;
          b += rgba[4 * i + 2] as number;
          const z = depth === null ? 0 : (depth[i] as number);
          if (z > 0 && Number.isFinite(z)) readings.push(z);
        }
      }
      const count = (bottom - top) * (right - left);
      const at = y * width + x;
      colours.set([(r + g + b) / 3 / count, (r - b) / count, (g - (r + b) / 2) / count], 3 * at);
      if (inverse !== null && readings.length > 0) {
        readings.sort((p, q) => p - q);
        inverse.data[at] = 1 / (readings[readings.length >> 1] as number);
      }
    }
  }
  return { box, cell, width, height, colours, inverse };
}
