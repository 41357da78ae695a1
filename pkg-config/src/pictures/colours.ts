/** Colours of depths and of depth differences. */

export type Rgb = readonly [red: number, green: number, blue: number];

/** The colours of the mesh, of the mask, and of pixels without a reading. */
export const MESH: Rgb = [240, 138, 36];
export const MASK: Rgb = [255, 255, 255];
const NO_READING: Rgb = [34, 34, 40];

/** From near to far: equal steps of depth are equal steps of lightness, and hues tell more of them apart. */
export const depthStops: readonly Rgb[] = [
  [240, 232, 130],
  [148, 212, 108],
  [66, 182, 126],
  [38, 146, 142],
  [48, 108, 142],
  [62, 66, 130],
  [58, 20, 84],
];

const between = (a: Rgb, b: Rgb, share: number) =>
  [0, 1, 2].map((k) => (a[k] as number) + ((b[k] as number) - (a[k] as number)) * share) as unknown as Rgb;

/** The colour of a depth, as a share of the way from near to far; `null` for no reading. */
export function depthColour(share: number | null): Rgb {
  if (share === null) return NO_READING;
  const place = Math.min(Math.max(share, 0), 1) * (depthStops.length - 1);
  const i = Math.min(Math.floor(place), depthStops.length - 2);
  return between(depthStops[i] as Rgb, depthStops[i + 1] as Rgb, place - i);
}

/** Blue where the mesh is nearer than the measured depth, orange where it is farther, white where both agree. */
export function differenceColour(differenceM: number, limitM: number): Rgb {
  const end: Rgb = differenceM < 0 ? [30, 100, 220] : [235, 95, 10];
  return between([248, 248, 248], end, Math.min(Math.abs(differenceM) / limitM, 1));
}

/** The difference that saturates the colour, metres: a fiftieth of the object's size, in round millimetres. */
export function differenceLimit(sizeM: number): number {
  const mm = Math.max(1, Math.round((1000 * sizeM) / 50));
  return (mm > 10 ? 5 * Math.round(mm / 5) : mm) / 1000;
}
