/** Colour maps of depths and differences. */
import { depthColour, depthStops, type Rgb } from "sim3align/pictures/colours";
import { once } from "../state/inputs.js";

/** The colours of depths as a gradient of CSS, from near to far. */
export const depthGradient = `linear-gradient(to right, ${depthStops.map((stop) => `rgb(${stop.join(" ")})`).join(", ")})`;

/**
 * A visualisation of a depth map with 256 levels: red, green, blue, alpha. Pixels without a reading are dark grey.
 * The intake sheet, the image view and the 3D view share the image of a depth map, so it must not be changed.
 */
export const depthImage = once((depthM: Float32Array): Uint8ClampedArray<ArrayBuffer> => {
  const { nearM: near, farM: far } = depthRange(depthM) ?? { nearM: 0, farM: 1 };
  const colours = Array.from({ length: 256 }, (_, i) => depthColour(i / 255));
  // One number per pixel, in the order of bytes that the machine has.
  const table = new Uint32Array(
    Uint8ClampedArray.from([...colours, depthColour(null)].flatMap((rgb) => [...rgb, 255])).buffer,
  );
  const image = new Uint8ClampedArray(4 * depthM.length);
  const pixels = new Uint32Array(image.buffer);
  const scale = 255 / (far - near || 1);
  for (let pixel = 0; pixel < depthM.length; pixel++) {
    const z = depthM[pixel] as number;
    const step = z > 0 ? Math.min(Math.max(Math.round((z - near) * scale), 0), 255) : 256;
    pixels[pixel] = table[step] as number;
  }
  return image;
});

/** The range of the readings without outliers, metres; null if there is none. */
export function depthRange(depthM: Float32Array): { nearM: number; medianM: number; farM: number } | null {
  // An odd step looks at all columns.
  const step = 2 * Math.floor(depthM.length / 40_000) + 1;
  const every = (step: number) => {
    const found: number[] = [];
    for (let pixel = 0; pixel < depthM.length; pixel += step) {
      const z = depthM[pixel] as number;
      if (z > 0 && Number.isFinite(z)) found.push(z);
    }
    return Float32Array.from(found).sort();
  };
  let readings = every(step);
  if (readings.length === 0) readings = every(1);
  if (readings.length === 0) return null;
  const at = (share: number) => readings[Math.floor(share * (readings.length - 1))] as number;
  return { nearM: at(0.01), medianM: at(0.5), farM: at(0.99) };
}

/** Parses #rrggbb. */
export function rgbOf(hex: string): Rgb {
  const number = Number.parseInt(hex.slice(1), 16);
  return [number >> 16, (number >> 8) & 255, number & 255];
}
