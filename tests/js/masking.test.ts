/** The mask tool of the page: its solver, its paths and its regions, against slow implementations and on made scenes. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { pageModule } from "../support/page-module.js";
import { forSeeds } from "../support/random.js";
import { maskIou } from "../support/results.js";

interface Size {
  width: number;
  height: number;
}
interface Stroke {
  points: readonly (readonly [number, number])[];
  radius: number;
  adds: boolean;
}
interface View extends Size {
  rgba: Uint8ClampedArray;
  depth: Float32Array | null;
}
const { walked, STEPS } = await pageModule<{
  walked(
    edges: Size & { weights: readonly Float64Array[] },
    ...numbers: [prior: Float64Array, trust: Float64Array, start: Float64Array, tolerance: number]
  ): Float64Array;
  STEPS: readonly (readonly [number, number])[];
}>("masking/walker");
const { distances } = await pageModule<{
  distances(size: Size, from: Iterable<readonly [number, number]>, costs: readonly Float64Array[]): Float64Array;
}>("masking/geodesic");
const { regionOf } = await pageModule<{ regionOf(view: View, strokes: readonly Stroke[]): Uint8Array }>(
  "masking/region",
);
/** Pairs of neighbours with their weights. */
function pairs({ width, height }: Size, weights: readonly Float64Array[]): [number, number, number][] {
  const found: [number, number, number][] = [];
  for (const [direction, [dx, dy]] of STEPS.entries()) {
    for (let i = 0; i < width * height; i++) {
      const [u, v] = [(i % width) + dx, Math.floor(i / width) + dy];
      if (u >= 0 && u < width && v < height) found.push([i, v * width + u, weights[direction]?.[i] ?? 0]);
    }
  }
  return found;
}

test("the random walker solves its linear system, and stays between the priors", () => {
  forSeeds(20, (random, seed) => {
    const size = { width: random.whole(1, 7), height: random.whole(1, 7) };
    const count = size.width * size.height;
    const values = (low: number, high: number) => Float64Array.from(random.list(count, low, high));
    const weights = STEPS.map(() => values(0, 1));
    const [prior, trust] = [values(0, 1), values(0.01, 0.51)];
    const found = walked({ ...size, weights }, prior, trust, prior, 1e-10);
    // The residual of (trust + Laplacian) x = trust · prior, pixel by pixel.
    const residual = Float64Array.from(found, (x, i) => (trust[i] ?? 0) * (x - (prior[i] ?? 0)));
    for (const [i, j, w] of pairs(size, weights)) {
      const flow = w * ((found[i] ?? 0) - (found[j] ?? 0));
      residual[i] = (residual[i] ?? 0) + flow;
      residual[j] = (residual[j] ?? 0) - flow;
    }
    for (const x of residual) assert.ok(Math.abs(x) < 1e-8, `${seed}: ${residual}`);
    const [low, high] = [Math.min(...prior), Math.max(...prior)];
    for (const x of found) assert.ok(x > low - 1e-7 && x < high + 1e-7, `${seed}: ${x}`);
  });
});

test("paths are the shortest: as by relaxing all steps until nothing changes", () => {
  forSeeds(20, (random, seed) => {
    const size = { width: random.whole(2, 10), height: random.whole(2, 10) };
    const count = size.width * size.height;
    const costs = STEPS.map(() => Float64Array.from(random.list(count, 0.01, 1)));
    const sources = [
      [0, 0.2],
      [count - 1, 0],
    ] as const;
    const expected = new Float64Array(count).fill(Number.POSITIVE_INFINITY);
    for (const [pixel, length] of sources) expected[pixel] = length;
    const steps = pairs(size, costs).flatMap(
      ([i, j, cost]) =>
        [
          [i, j, cost],
          [j, i, cost],
        ] as [number, number, number][],
    );
    for (let isChanged = true; isChanged; ) {
      isChanged = false;
      for (const [from, to, cost] of steps) {
        const length = (expected[from] ?? 0) + cost;
        if (length >= (expected[to] ?? 0)) continue;
        expected[to] = length;
        isChanged = true;
      }
    }
    assert.deepEqual(distances(size, sources, costs), expected, seed);
  });
});

/** A ball in front of a slanted table, and what a camera sees: the ball has the colours of the table in a pattern. */
function ballOnTable(hasColour: boolean) {
  const [width, height] = [160, 120];
  const truth = new Uint8Array(width * height);
  const depth = new Float32Array(width * height);
  const rgba = new Uint8ClampedArray(4 * width * height).fill(255);
  for (let i = 0; i < width * height; i++) {
    const [x, y] = [i % width, Math.floor(i / width)];
    const away = Math.hypot(x - 70, y - 60) / 25;
    truth[i] = away < 1 ? 1 : 0;
    // The inverse depth of a plane is linear.
    const table = 1 / (0.8 + 0.004 * y);
    depth[i] = away < 1 ? table - 0.12 * Math.sqrt(1 - away * away) - 0.05 : table;
    const checks = (Math.floor(x / 9) + Math.floor(y / 9)) % 2 === 0 ? 90 : 150;
    rgba.set(hasColour && away < 1 ? [200, 60, 40] : [checks, checks, checks], 4 * i);
  }
  return { view: { width, height, rgba, depth }, truth };
}

const click: Stroke = { points: [[70, 60]], radius: 1.5, adds: true };

test("one click finds an object by its colour, and by its depth where the colours are the same", () => {
  const [coloured, grey] = [ballOnTable(true), ballOnTable(false)];
  assert.ok(maskIou(regionOf({ ...coloured.view, depth: null }, [click]), coloured.truth) > 0.95);
  assert.ok(maskIou(regionOf(grey.view, [click]), grey.truth) > 0.9);
});

test("strokes are obeyed: what they cover is, or is not, in the region", () => {
  const { view, truth } = ballOnTable(true);
  const line = (from: [number, number], to: [number, number]) => ({ points: [from, to], radius: 3 });
  const remove: Stroke = { ...line([58, 50], [58, 70]), adds: false };
  const add: Stroke = { ...line([120, 30], [130, 30]), adds: true };
  const found = regionOf({ ...view, depth: null }, [click, remove, add]);
  for (const { points, adds } of [remove, add, click]) {
    for (const [x, y] of points) assert.equal(found[y * view.width + x], adds ? 1 : 0, `${x}, ${y}`);
  }
  assert.ok(found.reduce((sum, one) => sum + one, 0) < truth.length / 2);
  assert.ok(!regionOf(view, []).includes(1));
});
