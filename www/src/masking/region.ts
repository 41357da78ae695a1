/** The mask of an object from clicks and strokes on a photo, with its depth where there is one. Nothing is random. */
import { colourOdds } from "./colour-odds.js";
import { distances } from "./geodesic.js";
import { type Box, type Grid, gridOf, type View } from "./grid.js";
import { edgesOf, pricesOf, stepsOf } from "./steps.js";
import { eachCovered, type Stroke } from "./strokes.js";
import { supports } from "./support.js";
import { STEPS, walked } from "./walker.js";

/** Cells along the longer side: of the whole image, and of the box around what is found in it. */
const [COARSE, FINE] = [200, 300];
/** Log odds are at most this. */
const SUREST = 4;
/** A depth map with fewer readings is that of the object alone. */
const CUT_OUT = 0.25;
/** The length of a path beyond which a cell is rather not of the object, where depth tells it. */
const FAR = 1;
/** What a path pays for stepping on or off a support. */
const ONTO_SUPPORT = 1;
/** Objects may reach the border of the image, but mostly do not. */
const BORDER = 0.6;
/** What a hole in the depth map says, compared with a reading. */
const IN_HOLE = 0.5;
/** How much places are trusted by the walker, by colour, by depth, and in the box; and how much colours count beside places. */
const [BY_COLOUR, BY_DEPTH, IN_BOX, COLOURS] = [0.05, 0.2, 0.08, 0.6];
/** What was marked is certain. */
const MARKED = 100;
/** How often colours are learned. */
const ROUNDS = 2;
/** The margin of the box, in shares of its longer side. */
const MARGIN = 0.12;

/** 1 for the object, at the size of the view; empty without a stroke that adds. */
export function regionOf(view: View, strokes: readonly Stroke[]): Uint8Array {
  const { width, height } = view;
  const mask = new Uint8Array(width * height);
  const first = strokes.find(({ adds }) => adds)?.points[0];
  if (first === undefined) return mask;
  const whole = gridOf(view, { left: 0, top: 0, width, height }, COARSE);
  const rough = roughly(whole, strokes, first);
  const box = boxAround(whole, rough, strokes, view);
  const grid = gridOf(view, box, FINE);
  const soft = refined(grid, whole, rough, strokes);
  for (let y = box.top; y < box.top + box.height; y++) {
    for (let x = box.left; x < box.left + box.width; x++) {
      if (sampled(grid, soft, x, y) > 0.5) mask[y * width + x] = 1;
    }
  }
  return touched(mask, view, strokes);
}

/** 1 for cells that strokes add, -1 for those that they remove. */
function seedsOf({ box, cell, width, height }: Grid, strokes: readonly Stroke[]): Int8Array {
  const seeds = new Int8Array(width * height);
  for (const { points, radius, adds } of strokes) {
    const inCells = points.map(([x, y]) => [toCell(x, box.left, cell), toCell(y, box.top, cell)] as const);
    eachCovered({ points: inCells, radius: radius / cell }, width, height, (i) => {
      seeds[i] = adds ? 1 : -1;
    });
  }
  return seeds;
}

/** Where a pixel of the view is among the cells. The centres of both have integer coordinates. */
const toCell = (at: number, start: number, cell: number) => (at + 0.5 - start) / cell - 0.5;

/** The value of a grid at a pixel of the view, interpolated between cells. */
function sampled({ box, cell, width, height }: Grid, values: Float64Array, x: number, y: number): number {
  const u = Math.min(Math.max(toCell(x, box.left, cell), 0), width - 1);
  const v = Math.min(Math.max(toCell(y, box.top, cell), 0), height - 1);
  const [i, j] = [Math.floor(u), Math.floor(v)];
  const [a, b] = [u - i, v - j];
  const at = (p: number, q: number) => values[Math.min(q, height - 1) * width + Math.min(p, width - 1)] as number;
  return (1 - b) * ((1 - a) * at(i, j) + a * at(i + 1, j)) + b * ((1 - a) * at(i, j + 1) + a * at(i + 1, j + 1));
}

const clipped = (odds: number) => Math.min(SUREST, Math.max(-SUREST, odds));

/** The region in the whole image: the share of each cell that is of the object. */
function roughly(grid: Grid, strokes: readonly Stroke[], [x, y]: readonly [number, number]): Float64Array {
  const { width, height, inverse, cell } = grid;
  const count = width * height;
  const seeds = seedsOf(grid, strokes);
  const steps = stepsOf(grid);
  const within = (at: number, end: number) => Math.min(end - 1, Math.max(0, Math.floor(at / cell)));
  const clicked = within(y, height) * width + within(x, width);
  const reading = inverse === null ? clicked : nearestReading(inverse.data, width, clicked);
  const readings = inverse === null ? 0 : inverse.data.reduce((sum, z) => sum + (z > 0 ? 1 : 0), 0);
  const isCutOut = readings < CUT_OUT * count;
  const support = inverse === null || isCutOut ? null : supports(inverse, reading);
  const byDepth = (inverse?.data[reading] ?? 0) > 0 && (isCutOut || support?.includes(1) === true);
  const isSupport = (i: number) => byDepth && support?.[i] === 1 && (seeds[i] as number) <= 0;
  const prices = pricesOf(grid, steps, byDepth);
  if (byDepth) {
    for (const [d, [dx, dy]] of STEPS.entries()) {
      const price = prices[d] as Float64Array;
      for (let i = 0; i < count; i++) {
        if (isSupport(i) !== isSupport(i + dy * width + dx)) price[i] = (price[i] as number) + ONTO_SUPPORT;
      }
    }
  }
  const on: [number, number][] = [];
  const off: [number, number][] = [];
  for (let i = 0; i < count; i++) {
    const [u, v] = [i % width, Math.floor(i / width)];
    if (seeds[i] === 1) on.push([i, 0]);
    else if (seeds[i] === -1) off.push([i, 0]);
    else if (!byDepth && (u === 0 || v === 0 || u === width - 1 || v === height - 1)) off.push([i, BORDER]);
  }
  const outside = distances(grid, off, prices);
  const odds = distances(grid, on, prices).map((own, i) => {
    const ratio = Math.log(((outside[i] as number) + 0.01) / (own + 0.01));
    if (!byDepth) return clipped(ratio);
    const near = SUREST * (1 - own / FAR);
    if (isSupport(i)) return -SUREST;
    if ((inverse?.data[i] ?? 0) > 0) return clipped(Math.min(near, ratio));
    return clipped(Math.min(isCutOut ? -SUREST / 2 : IN_HOLE * near, ratio));
  });
  return solved(grid, seeds, odds, edgesOf(grid, steps), byDepth ? BY_DEPTH : BY_COLOUR);
}

/** The region in a box, on a finer grid. */
function refined(grid: Grid, whole: Grid, rough: Float64Array, strokes: readonly Stroke[]): Float64Array {
  const { box, cell, width, height } = grid;
  const odds = new Float64Array(width * height).map((_, i) => {
    const [x, y] = [box.left + ((i % width) + 0.5) * cell - 0.5, box.top + (Math.floor(i / width) + 0.5) * cell - 0.5];
    const share = Math.min(0.98, Math.max(0.02, sampled(whole, rough, x, y)));
    // What the whole image says is not to be learned again.
    return 1.5 * Math.log(share / (1 - share));
  });
  return solved(grid, seedsOf(grid, strokes), odds, edgesOf(grid, stepsOf(grid)), IN_BOX);
}

const sigmoid = (odds: number) => 1 / (1 + Math.exp(-odds));

/** The region, from what places say, in log odds, and from colours that are learned meanwhile. */
function solved(
  grid: Grid,
  seeds: Int8Array,
  places: Float64Array,
  edges: ReturnType<typeof edgesOf>,
  trust: number,
): Float64Array {
  const trusts = Float64Array.from(seeds, (seed) => (seed === 0 ? trust : MARKED));
  let soft: Float64Array = Float64Array.from(places, sigmoid);
  for (let round = 0; round <= ROUNDS; round++) {
    const colours = round === 0 ? null : colourOdds(grid, soft, seeds);
    const prior = Float64Array.from(seeds, (seed, i) =>
      seed !== 0
        ? Math.max(seed, 0)
        : sigmoid(clipped((places[i] as number) + (colours === null ? 0 : COLOURS * (colours[i] as number)))),
    );
    soft = walked(edges, prior, trusts, soft);
  }
  return soft;
}

/** The box of the region and of the strokes that add, with a margin. */
function boxAround(grid: Grid, soft: Float64Array, strokes: readonly Stroke[], view: View): Box {
  let [left, top, right, bottom] = [view.width, view.height, 0, 0];
  const take = (x: number, y: number, reach: number) => {
    [left, top] = [Math.min(left, x - reach), Math.min(top, y - reach)];
    [right, bottom] = [Math.max(right, x + reach), Math.max(bottom, y + reach)];
  };
  const { cell, width } = grid;
  soft.forEach((share, i) => {
    if (share > 0.5) take(((i % width) + 0.5) * cell, (Math.floor(i / width) + 0.5) * cell, cell);
  });
  for (const { points, radius, adds } of strokes) if (adds) for (const [x, y] of points) take(x, y, radius + cell);
  const margin = MARGIN * Math.max(right - left, bottom - top) + 3 * cell;
  const [x, y] = [Math.max(0, Math.floor(left - margin)), Math.max(0, Math.floor(top - margin))];
  return {
    ...{ left: x, top: y },
    width: Math.min(view.width, Math.ceil(right + margin)) - x,
    height: Math.min(view.height, Math.ceil(bottom + margin)) - y,
  };
}

/** The parts of a mask that strokes touch; marked pixels are of the object in any case. */
function touched(mask: Uint8Array, { width, height }: View, strokes: readonly Stroke[]): Uint8Array {
  const kept = new Uint8Array(mask.length);
  const stack: number[] = [];
  for (const { points, adds } of strokes) {
    if (adds) eachCovered({ points, radius: 0 }, width, height, (pixel) => stack.push(pixel));
  }
  for (let pixel = stack.pop(); pixel !== undefined; pixel = stack.pop()) {
    if (mask[pixel] === 0 || kept[pixel] === 1) continue;
    kept[pixel] = 1;
    const x = pixel % width;
    if (x > 0) stack.push(pixel - 1);
    if (x < width - 1) stack.push(pixel + 1);
    if (pixel >= width) stack.push(pixel - width);
    if (pixel + width < mask.length) stack.push(pixel + width);
  }
  return kept;
}

/** Cells around a click in which a reading is looked for. */
const NEARBY = 6;

/** The nearest cell with a reading; the cell itself if there is none nearby. */
function nearestReading(data: Float64Array, width: number, cell: number): number {
  const [x, y] = [cell % width, Math.floor(cell / width)];
  for (let reach = 0; reach <= NEARBY; reach++) {
    for (let v = y - reach; v <= y + reach; v++) {
      for (let u = x - reach; u <= x + reach; u++) {
        const at = v * width + u;
        if (u >= 0 && u < width && (data[at] ?? 0) > 0) return at;
      }
    }
  }
  return cell;
}
