/** What lies between neighbouring cells of a grid: steps of colour and depth, creases, and holes of the depth map. */
import type { Grid } from "./grid.js";
import { type Edges, eachPair, STEPS } from "./walker.js";

/** Differences of colour count twice as much as those of brightness: shadows fall on objects, too. */
const CHROMA = 2;
/** The difference of colours at which the walker meets an edge, and the one that a path pays 1 for. */
const [EDGE, PAID] = [10, 14];
/** Steps of depth from one cell to the next, relative: what slanted surfaces have, and what is an edge beyond that. */
const [SLOPE, JUMP] = [0.012, 0.02];
/** Creases, relative: the noise of sensors, and what is an edge beyond that. */
const [NOISE, CREASE] = [0.0015, 0.003];
/** What a path pays for jumps and creases at most, for crossing the edge of a hole, and how much colours count beside depth. */
const [JUMP_PRICE, STEEPEST, HOLE_PRICE, BESIDE_DEPTH] = [3, 3, 0.5, 0.03];
/** What a path pays for its length: the longer side of the image costs this much. */
const [LENGTH, LENGTH_BY_DEPTH] = [2, 0.4];
/** What is left of the weight of an edge. */
const LEAST_WEIGHT = 1e-3;
/** Cells from a pair of neighbours at which a crease is measured, and those around each that are averaged for it. */
const [REACH, AROUND] = [2, 2];
/** Readings that differ more, relative, are of other surfaces. */
const SAME_SURFACE = 0.02;

/** By direction, as in {@link STEPS}. */
type ByDirection = readonly Float64Array[];

/** Squared differences of colours, and relative steps and creases of the depth. */
export interface Steps {
  colour: ByDirection;
  depth: ByDirection;
  crease: ByDirection;
}

export function stepsOf({ width, height, colours, inverse }: Grid): Steps {
  const make = () => STEPS.map(() => new Float64Array(width * height));
  const [colour, depth, crease] = [make(), make(), make()];
  const even = inverse === null ? new Float64Array() : smoothed(inverse.data, width, height);
  eachPair({ width, height }, (a, b, direction) => {
    const [l, p, q] = [0, 1, 2].map((k) => (colours[3 * a + k] as number) - (colours[3 * b + k] as number)) as [
      number,
      number,
      number,
    ];
    // Diagonal steps are longer.
    (colour[direction] as Float64Array)[a] = (l * l + CHROMA * CHROMA * (p * p + q * q)) * (direction < 2 ? 1 : 0.5);
    if (inverse === null) return;
    const [z, w] = [inverse.data[a] as number, inverse.data[b] as number];
    (depth[direction] as Float64Array)[a] = z > 0 && w > 0 ? Math.abs(z - w) / Math.min(z, w) : 0;
    // Over the image, the inverse depth of a plane is linear. It bends upwards where an object touches what is behind or
    // beside it.
    const step = REACH * (b - a);
    const [near, far] = [even[a] as number, even[b] as number];
    const [before, after] = [even[a - step] ?? 0, even[b + step] ?? 0];
    if (near > 0 && far > 0 && before > 0 && after > 0) {
      (crease[direction] as Float64Array)[a] = Math.max(0, (before + after - near - far) / (near + far));
    }
  });
  return { colour, depth, crease };
}

/** Means of the readings around each, as far as they are of one surface. */
function smoothed(data: Float64Array, width: number, height: number): Float64Array {
  return Float64Array.from(data, (own, i) => {
    if (!(own > 0)) return 0;
    const [x, y] = [i % width, Math.floor(i / width)];
    let [sum, count] = [0, 0];
    for (let v = Math.max(0, y - AROUND); v <= Math.min(height - 1, y + AROUND); v++) {
      for (let u = Math.max(0, x - AROUND); u <= Math.min(width - 1, x + AROUND); u++) {
        const z = data[v * width + u] as number;
        if (Math.abs(z - own) < SAME_SURFACE * own) [sum, count] = [sum + z, count + 1];
      }
    }
    return sum / count;
  });
}

/** The weights of the random walker: small across edges. */
export function edgesOf({ width, height }: Grid, { colour, depth, crease }: Steps): Edges {
  const weights = STEPS.map((_, d) =>
    Float64Array.from(colour[d] as Float64Array, (difference, i) => {
      const [jump, bend] = [(depth[d]?.[i] as number) / JUMP, (crease[d]?.[i] as number) / CREASE];
      const weight = Math.exp(-difference / (2 * EDGE * EDGE) - jump * jump - bend * bend) + LEAST_WEIGHT;
      return weight * (d < 2 ? 1 : Math.SQRT1_2);
    }),
  );
  return { width, height, weights: weights as unknown as Edges["weights"] };
}

/** What paths pay: for edges of the depth where it tells the object, otherwise for those of colours. */
export function pricesOf({ width, height, inverse }: Grid, steps: Steps, byDepth: boolean): Float64Array[] {
  const longest = Math.max(width, height);
  const isHole = (i: number) => inverse !== null && !((inverse.data[i] ?? 0) > 0);
  return STEPS.map(([dx, dy], d) =>
    Float64Array.from(steps.colour[d] as Float64Array, (difference, i) => {
      const jump = Math.min(STEEPEST, Math.max(0, (steps.depth[d]?.[i] as number) - SLOPE) / JUMP);
      const bend = Math.min(STEEPEST, Math.max(0, (steps.crease[d]?.[i] as number) - NOISE) / CREASE);
      const edge = isHole(i) !== isHole(i + dy * width + dx) ? HOLE_PRICE : 0;
      const shape = JUMP_PRICE * jump + bend + edge;
      const seen = Math.min(4, difference / (PAID * PAID));
      const length = (d < 2 ? 1 : Math.SQRT2) / longest;
      return byDepth && !isHole(i)
        ? LENGTH_BY_DEPTH * length + BESIDE_DEPTH * seen + shape
        : LENGTH * length + seen + BESIDE_COLOURS * shape;
    }),
  );
}

/** How much depth counts where it does not tell the object. */
const BESIDE_COLOURS = 0.3;
