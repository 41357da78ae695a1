/** Colour maps of depths and differences. */
import { once } from "../load/once.js";

export type Rgb = readonly [red: number, green: number, blue: number];

/** From near to far: equal steps of depth are equal steps of lightness, and hues tell more of them apart. */
const stops: readonly Rgb[] = [
  [240, 232, 130],
  [148, 212, 108],
  [66, 182, 126],
  [38, 146, 142],
  [48, 108, 142],
  [62, 66, 130],
  [58, 20, 84],
];

/** The colours of depths as a gradient of CSS, from near to far. */
export const depthGradient = `linear-gradient(to right, ${stops.map((stop) => `rgb(${stop.join(" ")})`).join(", ")})`;

const between = (a: number, b: number, share: number) => a + (b - a) * share;

const NO_READING: Rgb = [34, 34, 40];

/** The colour of a depth, as a share of the way from near to far. */
function depthColour(share: number): Rgb {
  const place = Math.min(Math.max(share, 0), 1) * (stops.length - 1);
  const i = Math.min(Math.floor(place), stops.length - 2);
  const [a, b] = [stops[i] as Rgb, stops[i + 1] as Rgb];
  return [0, 1, 2].map((k) => between(a[k] as number, b[k] as number, place - i)) as unknown as Rgb;
}

/**
 * A visualisation of a depth map with 256 levels: red, green, blue, alpha. Pixels without a reading are dark grey.
 * The intake sheet, the image view and the 3D view share the image of a depth map, so it must not be changed.
 */
export const depthImage = once((depthM: Float32Array): Uint8ClampedArray<ArrayBuffer> => {
  const { nearM: near, farM: far } = depthRange(depthM) ?? { nearM: 0, farM: 1 };
  const colours = Array.from({ length: 256 }, (_, i) => depthColour(i / 255));
  // One number per pixel, in the order of bytes that the machine has.
  const table = new Uint32Array(
    Uint8ClampedArray.from([...colours, NO_READING].flatMap((rgb) => [...rgb, 255])).buffer,
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

/** Blue if the mesh is nearer than the measured depth, orange if it is farther, white if both agree. */
export function differenceColour(differenceM: number, limitM: number): Rgb {
  const share = Math.min(Math.abs(differenceM) / limitM, 1);
  const end: Rgb = differenceM < 0 ? [30, 100, 220] : [235, 95, 10];
  return end.map((x) => between(248, x, share)) as unknown as Rgb;
}

/** Parses #rrggbb. */
export function rgbOf(hex: string): Rgb {
  const number = Number.parseInt(hex.slice(1), 16);
  return [number >> 16, (number >> 8) & 255, number & 255];
}
