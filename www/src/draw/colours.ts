/** Colour maps of depths and differences. */

export type Rgb = readonly [red: number, green: number, blue: number];

/** From near to far. A single hue, so that overlays stand out. */
const stops: readonly Rgb[] = [
  [226, 232, 240],
  [150, 165, 184],
  [92, 108, 130],
  [52, 64, 84],
  [22, 28, 40],
];

const between = (a: number, b: number, share: number) => a + (b - a) * share;

/** The colour of a depth, as a share of the way from near to far. */
function depthColour(share: number): Rgb {
  const place = Math.min(Math.max(share, 0), 1) * (stops.length - 1);
  const i = Math.min(Math.floor(place), stops.length - 2);
  const [a, b] = [stops[i] as Rgb, stops[i + 1] as Rgb];
  return [0, 1, 2].map((k) => between(a[k] as number, b[k] as number, place - i)) as unknown as Rgb;
}

/** A visualisation of a depth map with 256 levels: red, green, blue, alpha. Pixels without a reading are black. */
export function depthImage(depthM: Float32Array): Uint8ClampedArray<ArrayBuffer> {
  const stride = Math.max(1, Math.floor(depthM.length / 20_000));
  const readings = depthM.filter((z, pixel) => pixel % stride === 0 && z > 0 && Number.isFinite(z)).sort();
  // Without outliers.
  const near = readings[Math.floor(0.01 * readings.length)] ?? 0;
  const far = readings[Math.floor(0.99 * readings.length)] ?? 1;
  const table = Array.from({ length: 256 }, (_, i) => depthColour(i / 255));
  const image = new Uint8ClampedArray(4 * depthM.length);
  depthM.forEach((z, pixel) => {
    const step = Math.round((255 * (z - near)) / (far - near || 1));
    const [red, green, blue] = z > 0 ? (table[Math.min(Math.max(step, 0), 255)] as Rgb) : [0, 0, 0];
    image.set([red, green, blue, 255], 4 * pixel);
  });
  return image;
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
