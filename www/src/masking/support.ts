/** The planes on which objects stand, without a camera: over the image, the inverse depth of a plane is linear. */

/** Inverse depth at the pixels of a grid; 0 is no reading. */
export interface InverseDepth {
  data: Float64Array;
  width: number;
  height: number;
}

/** Inverse depth a·x + b·y + c. */
type Plane = readonly [a: number, b: number, c: number];

/** How far readings of a plane are from it, relative to the depth: noise of sensors, and bends of models. */
const THICKNESS = 0.006;
/** Planes with a smaller share of the readings support nothing. */
const LEAST_SHARE = 0.06;
const TRIALS = 300;
const MOST_PLANES = 3;

/**
 * The pixels on planes that the clicked pixel is in front of: table, floor, walls.
 *
 * @param pixel where the object was clicked
 * @returns 1 on a plane
 */
export function supports(depth: InverseDepth, pixel: number): Uint8Array {
  const { data, width } = depth;
  const found = new Uint8Array(data.length);
  const own = data[pixel] as number;
  if (!(own > 0)) return found;
  const readings: number[] = [];
  for (let i = 0; i < data.length; i++) if ((data[i] as number) > 0) readings.push(i);
  const at = ([a, b, c]: Plane, i: number) => a * (i % width) + b * Math.floor(i / width) + c;
  const isNear = (plane: Plane, i: number) => Math.abs(1 - at(plane, i) / (data[i] as number)) < THICKNESS;
  const random = generator(readings.length);
  let rest = readings;
  for (let round = 0; round < MOST_PLANES; round++) {
    let [best, most]: [Plane | null, number] = [null, LEAST_SHARE * readings.length];
    // Every few readings are enough to compare planes by.
    const step = Math.max(1, Math.floor(rest.length / 2000));
    for (let trial = 0; trial < TRIALS; trial++) {
      const plane = through(depth, [0, 1, 2].map(() => rest[Math.floor(random() * rest.length)] ?? 0) as Three);
      // The click is nearer than the plane.
      if (plane === null || 1 - at(plane, pixel) / own < 1.5 * THICKNESS) continue;
      let count = 0;
      for (let k = 0; k < rest.length; k += step) if (isNear(plane, rest[k] as number)) count += step;
      if (count > most) [best, most] = [plane, count];
    }
    if (best === null) break;
    const plane = best;
    for (const i of readings) if (isNear(plane, i)) found[i] = 1;
    rest = rest.filter((i) => !isNear(plane, i));
  }
  return found;
}

type Three = [number, number, number];

/** The plane through three readings; null if they are in line. */
function through({ data, width }: InverseDepth, pixels: Three): Plane | null {
  const [[x0, y0, z0], [x1, y1, z1], [x2, y2, z2]] = pixels.map((i) => [
    i % width,
    Math.floor(i / width),
    data[i] as number,
  ]) as [Three, Three, Three];
  const area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0);
  if (Math.abs(area) < 1) return null;
  const a = ((z1 - z0) * (y2 - y0) - (z2 - z0) * (y1 - y0)) / area;
  const b = ((x1 - x0) * (z2 - z0) - (x2 - x0) * (z1 - z0)) / area;
  return [a, b, z0 - a * x0 - b * y0];
}

/** Numbers from 0 to 1, the same for the same seed: a linear congruential generator. */
function generator(seed: number): () => number {
  let state = (seed >>> 0) + 1;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}
