/** The mask of an object from clicks and strokes on a photo, with its depth where there is one. Nothing is random. */
import { distances } from "./geodesic.js";
import { type Box, type Grid, gridOf, type View } from "./grid.js";
import { supports } from "./support.js";
import { type Edges, eachPair, STEPS, walked } from "./walker.js";

/** A click or a stroke of the brush. */
export interface Stroke {
  /** In pixels of the view; one point is a click. */
  points: readonly (readonly [x: number, y: number])[];
  /** Of the brush, pixels. */
  radius: number;
  /** Whether it is on the object, or on what is not the object. */
  adds: boolean;
}

export const T = {
  coarse: 200,
  fine: 300,
  chroma: 2,
  sigmaG: 14,
  sigmaW: 10,
  stepG: 0.01,
  jump0: 0.012,
  jumpS: 0.02,
  depthColour: 0.03,
  border: 0.6,
  geoW: 1,
  llrW: 0.6,
  trust: 0.05,
  jumpW: 3,
  eps: 1e-3,
  clip: 4,
  rounds: 2,
  ratio: 1,
  fineTrust: 0.08,
  concave: 1.0,
  concave0: 0.004,
  concaveS: 0.01,
  few: 0.25,
  hole: 0.5,
  stepD: 0.2,
  onto: 1,
  reach: 2,
  trustD: 0.2,
};

/** 1 for the object, at the size of the view; empty without a stroke that adds. */
export function regionOf(view: View, strokes: readonly Stroke[]): Uint8Array {
  const { width, height } = view;
  const mask = new Uint8Array(width * height);
  const first = strokes.find(({ adds }) => adds)?.points[0];
  if (first === undefined) return mask;
  const whole = gridOf(view, { left: 0, top: 0, width, height }, T.coarse);
  const rough = coarse(whole, strokes, first);
  const box = boxAround(whole, rough, strokes, view);
  const grid = gridOf(view, box, T.fine);
  const soft = fine(grid, whole, rough, strokes);
  for (let y = Math.floor(box.top); y < box.top + box.height; y++) {
    for (let x = Math.floor(box.left); x < box.left + box.width; x++) {
      if (x < 0 || y < 0 || x >= width || y >= height) continue;
      if (sampled(grid, soft, x, y) > 0.5) mask[y * width + x] = 1;
    }
  }
  return connected(mask, view, strokes);
}

/** The value of a grid at a pixel of the view, between cells. */
function sampled({ box, cell, width, height }: Grid, values: ArrayLike<number>, x: number, y: number): number {
  const u = Math.min(Math.max((x + 0.5 - box.left) / cell - 0.5, 0), width - 1);
  const v = Math.min(Math.max((y + 0.5 - box.top) / cell - 0.5, 0), height - 1);
  const [i, j] = [
    Math.min(Math.floor(u), width - 2 < 0 ? 0 : width - 2),
    Math.min(Math.floor(v), height - 2 < 0 ? 0 : height - 2),
  ];
  const [a, b] = [u - i, v - j];
  const at = (p: number, q: number) => values[Math.min(q, height - 1) * width + Math.min(p, width - 1)] as number;
  return (1 - b) * ((1 - a) * at(i, j) + a * at(i + 1, j)) + b * ((1 - a) * at(i, j + 1) + a * at(i + 1, j + 1));
}

/** 1 where a stroke adds, -1 where one takes away, the later before the earlier. */
function seedsOf({ box, cell, width, height }: Grid, strokes: readonly Stroke[]): Int8Array {
  const seeds = new Int8Array(width * height);
  for (const { points, radius, adds } of strokes) {
    const r = Math.max(radius / cell, 0.71);
    const at = points.map(([x, y]) => [(x + 0.5 - box.left) / cell - 0.5, (y + 0.5 - box.top) / cell - 0.5] as const);
    at.forEach((to, k) => {
      const from = at[Math.max(0, k - 1)] as readonly [number, number];
      const [x0, x1] = [Math.min(from[0], to[0]) - r, Math.max(from[0], to[0]) + r];
      const [y0, y1] = [Math.min(from[1], to[1]) - r, Math.max(from[1], to[1]) + r];
      for (let y = Math.max(0, Math.ceil(y0)); y <= Math.min(height - 1, y1); y++) {
        for (let x = Math.max(0, Math.ceil(x0)); x <= Math.min(width - 1, x1); x++) {
          if (toSegment(x, y, from, to) <= r) seeds[y * width + x] = adds ? 1 : -1;
        }
      }
    });
  }
  return seeds;
}

function toSegment(
  x: number,
  y: number,
  [x0, y0]: readonly [number, number],
  [x1, y1]: readonly [number, number],
): number {
  const [dx, dy] = [x1 - x0, y1 - y0];
  const length = dx * dx + dy * dy;
  const t = length === 0 ? 0 : Math.min(1, Math.max(0, ((x - x0) * dx + (y - y0) * dy) / length));
  return Math.hypot(x - x0 - t * dx, y - y0 - t * dy);
}

/** Squared differences of colours and steps of depth between neighbours. */
function stepsOf({ width, height, colours, inverse }: Grid) {
  const make = () => STEPS.map(() => new Float64Array(width * height));
  const [colour, depth, concave] = [make(), make(), make()];
  eachPair({ width, height }, (a, b, direction) => {
    const [l, p, q] = [0, 1, 2].map((k) => (colours[3 * a + k] as number) - (colours[3 * b + k] as number)) as [
      number,
      number,
      number,
    ];
    const along = direction < 2 ? 1 : 0.5;
    (colour[direction] as Float64Array)[a] = (l * l + T.chroma * T.chroma * (p * p + q * q)) * along;
    if (inverse === null) return;
    const [z, w] = [inverse.data[a] as number, inverse.data[b] as number];
    (depth[direction] as Float64Array)[a] = z > 0 && w > 0 ? Math.abs(z - w) / Math.min(z, w) : 0;
    // Second difference over a few cells: positive in the creases where objects touch what is behind or beside them.
    const step = b - a;
    const [far, near] = [inverse.data[a - 2 * step], inverse.data[b + 2 * step]];
    if (z > 0 && w > 0 && far !== undefined && near !== undefined && far > 0 && near > 0) {
      (concave[direction] as Float64Array)[a] = Math.max(0, (far + near - z - w) / (z + w));
    }
  });
  return { colour, depth, concave };
}

function coarse(grid: Grid, strokes: readonly Stroke[], [x, y]: readonly [number, number]): Float64Array {
  const { width, height, inverse, cell } = grid;
  const count = width * height;
  const seeds = seedsOf(grid, strokes);
  const click = Math.min(height - 1, Math.floor(y / cell)) * width + Math.min(width - 1, Math.floor(x / cell));
  const { colour, depth, concave } = stepsOf(grid);
  const readings = inverse === null ? 0 : inverse.data.reduce((sum, z) => sum + (z > 0 ? 1 : 0), 0);
  const isCutOut = readings < T.few * count;
  const behind = inverse === null || isCutOut ? null : supports(inverse, nearestReading(inverse.data, width, click));
  const clickHas = inverse !== null && (inverse.data[nearestReading(inverse.data, width, click)] as number) > 0;
  const byDepth = clickHas && ((behind?.includes(1) ?? false) || isCutOut);
  const longest = Math.max(width, height);
  const costs = STEPS.map(([dx, dy], d) =>
    Float64Array.from(colour[d] as Float64Array, (c, i) => {
      const jump = Math.max(0, ((depth[d] as Float64Array)[i] as number) - T.jump0) / T.jumpS;
      const crease = Math.max(0, ((concave[d] as Float64Array)[i] as number) - T.concave0) / T.concaveS;
      const hole =
        inverse !== null && (inverse.data[i] as number) > 0 !== (inverse.data[i + dy * width + dx] ?? 0) > 0
          ? T.hole
          : 0;
      const shape = T.jumpW * Math.min(3, jump) + T.concave * Math.min(3, crease) + hole;
      const step = T.stepG * (d < 2 ? 1 : Math.SQRT2) * (200 / longest);
      const seen = Math.min(4, c / (T.sigmaG * T.sigmaG));
      return byDepth ? T.stepD * step + T.depthColour * seen + shape : step + seen + 0.3 * shape;
    }),
  );
  const on: [number, number][] = [];
  const off: [number, number][] = [];
  for (let i = 0; i < count; i++) {
    const seed = seeds[i] as number;
    const [u, v] = [i % width, Math.floor(i / width)];
    if (seed > 0) on.push([i, 0]);
    else if (seed < 0) off.push([i, 0]);
    else if (!byDepth && (u === 0 || v === 0 || u === width - 1 || v === height - 1)) off.push([i, T.border]);
  }
  const isSupport = (i: number) => byDepth && behind?.[i] === 1 && (seeds[i] as number) <= 0;
  if (byDepth) {
    costs.forEach((cost, d) => {
      const [dx, dy] = STEPS[d] as readonly [number, number];
      for (let i = 0; i < count; i++)
        if (isSupport(i) !== isSupport(i + dy * width + dx)) cost[i] = (cost[i] as number) + T.onto;
    });
  }
  const inside = distances(grid, on, costs);
  const outside = distances(grid, off, costs);
  const places = Float64Array.from(inside, (own, i) => {
    const other = outside[i] as number;
    const ratio = T.geoW * Math.log((other + 1e-2) / (T.ratio * own + 1e-2));
    const near = byDepth
      ? isSupport(i)
        ? -T.clip
        : (inverse?.data[i] ?? 0) > 0
          ? T.clip * (1 - own / T.reach)
          : isCutOut
            ? -T.clip / 2
            : 0.5 * (1 - own / T.reach)
      : T.clip;
    return Math.min(T.clip, Math.max(-T.clip, Math.min(near, ratio)));
  });
  return solved(grid, seeds, places, edgesOf(grid, colour, depth, concave), byDepth ? T.trustD : T.trust);
}

/** The edge weights of the random walker. */
function edgesOf(
  { width, height }: Grid,
  colour: readonly Float64Array[],
  depth: readonly Float64Array[],
  concave: readonly Float64Array[],
): Edges {
  const weights = STEPS.map((_, d) =>
    Float64Array.from(colour[d] as Float64Array, (c, i) => {
      const jump = ((depth[d] as Float64Array)[i] as number) / T.jumpS;
      const crease = ((concave[d] as Float64Array)[i] as number) / T.concaveS;
      return (
        (Math.exp(-c / (2 * T.sigmaW * T.sigmaW) - jump * jump - crease * crease) + T.eps) * (d < 2 ? 1 : Math.SQRT1_2)
      );
    }),
  );
  return { width, height, weights: weights as unknown as Edges["weights"] };
}

const sigmoid = (t: number) => 1 / (1 + Math.exp(-t));

/** Soft regions from what places say, log odds, and from colours that are learned meanwhile. */
function solved(grid: Grid, seeds: Int8Array, places: Float64Array, edges: Edges, trust: number): Float64Array {
  const count = seeds.length;
  let soft: Float64Array = Float64Array.from(places, sigmoid);
  for (let round = 0; round <= T.rounds; round++) {
    const likelihood = round === 0 ? null : colourOdds(grid, soft, seeds);
    const [prior, trusts] = [new Float64Array(count), new Float64Array(count)];
    for (let i = 0; i < count; i++) {
      const seed = seeds[i] as number;
      const odds = (places[i] as number) + (likelihood === null ? 0 : T.llrW * (likelihood[i] as number));
      prior[i] = seed !== 0 ? (seed > 0 ? 1 : 0) : sigmoid(Math.min(T.clip, Math.max(-T.clip, odds)));
      trusts[i] = seed !== 0 ? 100 : trust;
    }
    soft = walked(edges, prior, trusts, soft);
  }
  return soft;
}

const LEVELS = 12;

/** Log odds of the colours of inside and outside, from smoothed histograms. */
function colourOdds({ colours, width, height }: Grid, soft: Float64Array, seeds: Int8Array): Float64Array {
  const count = width * height;
  const bins = LEVELS ** 3;
  const [inside, outside] = [new Float64Array(bins), new Float64Array(bins)];
  const level = (value: number, from: number, to: number) =>
    Math.min(LEVELS - 1, Math.max(0, Math.floor((LEVELS * (value - from)) / (to - from))));
  const bin = Int32Array.from(
    { length: count },
    (_, i) =>
      (level(colours[3 * i] as number, 0, 256) * LEVELS + level(colours[3 * i + 1] as number, -96, 96)) * LEVELS +
      level(colours[3 * i + 2] as number, -64, 64),
  );
  let [ins, outs] = [0, 0];
  for (let i = 0; i < count; i++) {
    const share = (soft[i] as number) > 0.5 ? 1 : 0;
    const b = bin[i] as number;
    const w = seeds[i] === 0 ? 1 : 3;
    inside[b] = (inside[b] as number) + share * w;
    outside[b] = (outside[b] as number) + (1 - share) * w;
    ins += share * w;
    outs += (1 - share) * w;
  }
  const [p, q] = [blurred(inside), blurred(outside)];
  return Float64Array.from(bin, (b) => {
    const [a, c] = [(p[b] as number) / (ins || 1), (q[b] as number) / (outs || 1)];
    const floor = 3 / count;
    return Math.log((a + floor) / (c + floor));
  });
}

function blurred(bins: Float64Array): Float64Array {
  let now = bins;
  for (const step of [1, LEVELS, LEVELS * LEVELS]) {
    const next = Float64Array.from(now, (value) => 0.5 * value);
    now.forEach((value, i) => {
      const k = Math.floor(i / step) % LEVELS;
      const before = k > 0 ? i - step : i;
      const after = k < LEVELS - 1 ? i + step : i;
      next[before] = (next[before] as number) + 0.25 * value;
      next[after] = (next[after] as number) + 0.25 * value;
    });
    now = next;
  }
  return now;
}

function fine(grid: Grid, whole: Grid, rough: Float64Array, strokes: readonly Stroke[]): Float64Array {
  const seeds = seedsOf(grid, strokes);
  const places = new Float64Array(seeds.length);
  for (let y = 0; y < grid.height; y++) {
    for (let x = 0; x < grid.width; x++) {
      const p = sampled(
        whole,
        rough,
        grid.box.left + (x + 0.5) * grid.cell - 0.5,
        grid.box.top + (y + 0.5) * grid.cell - 0.5,
      );
      const q = Math.min(0.98, Math.max(0.02, p));
      places[y * grid.width + x] = 1.5 * Math.log(q / (1 - q));
    }
  }
  const { colour, depth, concave } = stepsOf(grid);
  return solved(grid, seeds, places, edgesOf(grid, colour, depth, concave), T.fineTrust);
}

/** The box of the region and the strokes that add, with a margin. */
function boxAround(grid: Grid, soft: Float64Array, strokes: readonly Stroke[], view: View): Box {
  let [left, top, right, bottom] = [view.width, view.height, 0, 0];
  const take = (x: number, y: number, r: number) => {
    [left, top] = [Math.min(left, x - r), Math.min(top, y - r)];
    [right, bottom] = [Math.max(right, x + r), Math.max(bottom, y + r)];
  };
  soft.forEach((p, i) => {
    if (p > 0.5) take(((i % grid.width) + 0.5) * grid.cell, (Math.floor(i / grid.width) + 0.5) * grid.cell, grid.cell);
  });
  for (const { points, radius, adds } of strokes) if (adds) for (const [x, y] of points) take(x, y, radius + grid.cell);
  const margin = 0.12 * Math.max(right - left, bottom - top) + 3 * grid.cell;
  const [x0, y0] = [Math.max(0, Math.floor(left - margin)), Math.max(0, Math.floor(top - margin))];
  return {
    left: x0,
    top: y0,
    width: Math.min(view.width, Math.ceil(right + margin)) - x0,
    height: Math.min(view.height, Math.ceil(bottom + margin)) - y0,
  };
}

/** The parts of the mask that strokes touch. */
function connected(mask: Uint8Array, { width, height }: View, strokes: readonly Stroke[]): Uint8Array {
  const kept = new Uint8Array(mask.length);
  const stack: number[] = [];
  for (const { points, adds } of strokes) {
    if (!adds) continue;
    for (const [x, y] of points)
      stack.push(
        Math.min(height - 1, Math.max(0, Math.round(y))) * width + Math.min(width - 1, Math.max(0, Math.round(x))),
      );
  }
  for (let pixel = stack.pop(); pixel !== undefined; pixel = stack.pop()) {
    if (mask[pixel] === 0 || kept[pixel] === 1) continue;
    kept[pixel] = 1;
    const [x, y] = [pixel % width, Math.floor(pixel / width)];
    if (x > 0) stack.push(pixel - 1);
    if (x < width - 1) stack.push(pixel + 1);
    if (y > 0) stack.push(pixel - width);
    if (y < height - 1) stack.push(pixel + width);
  }
  return kept;
}

function nearestReading(data: Float64Array, width: number, pixel: number): number {
  const [x, y] = [pixel % width, Math.floor(pixel / width)];
  for (let r = 0; r <= 6; r++) {
    for (let v = y - r; v <= y + r; v++) {
      for (let u = x - r; u <= x + r; u++) {
        const at = v * width + u;
        if (u >= 0 && u < width && (data[at] ?? 0) > 0) return at;
      }
    }
  }
  return pixel;
}
