/** The mask tool of the page: its solver, its paths and its regions, against slow implementations and on made scenes. */
import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { build } from "esbuild";
import { installDir, repository } from "../support/environment.js";
import { Random } from "../support/random.js";

interface Stroke {
  points: readonly (readonly [number, number])[];
  radius: number;
  adds: boolean;
}
interface View {
  width: number;
  height: number;
  rgba: Uint8ClampedArray;
  depth: Float32Array | null;
}
type Weights = readonly [Float64Array, Float64Array, Float64Array, Float64Array];
let walked: (
  edges: { width: number; height: number; weights: Weights },
  prior: Float64Array,
  trust: Float64Array,
  start?: Float64Array,
  tolerance?: number,
) => Float64Array;
let STEPS: readonly (readonly [number, number])[];
let distances: (
  size: { width: number; height: number },
  sources: Iterable<readonly [number, number]>,
  costs: readonly Float64Array[],
) => Float64Array;
let regionOf: (view: View, strokes: readonly Stroke[]) => Uint8Array;
let painted: (
  marks: readonly (Stroke & { followsEdges: boolean })[],
  region: Uint8Array | null,
  before: Uint8Array | null,
  size: { width: number; height: number },
) => Uint8Array;
let declaredTriangles: (file: {
  path: string;
  size: number;
  bytes(): Promise<Uint8Array>;
  head(length: number): Promise<Uint8Array>;
}) => Promise<number | null>;

before(async () => {
  const folder = join(installDir, "masking");
  mkdirSync(folder, { recursive: true });
  const names = ["masking/walker", "masking/geodesic", "masking/region", "masking/strokes", "load/mesh-header"];
  await build({
    entryPoints: names.map((name) => join(repository, "www", "src", `${name}.ts`)),
    ...{
      bundle: true,
      format: "esm",
      outdir: folder,
      outbase: join(repository, "www", "src"),
      external: ["sim3align"],
    },
    outExtension: { ".js": ".mjs" },
  });
  const load = (name: string) => import(pathToFileURL(join(folder, `${name}.mjs`)).href);
  ({ walked, STEPS } = await load("masking/walker"));
  ({ distances } = await load("masking/geodesic"));
  ({ regionOf } = await load("masking/region"));
  ({ painted } = await load("masking/strokes"));
  ({ declaredTriangles } = await load("load/mesh-header"));
});

/** Pairs of neighbours with their weights. */
function pairs(width: number, height: number, weights: readonly Float64Array[]): [number, number, number][] {
  const found: [number, number, number][] = [];
  STEPS.forEach(([dx, dy], direction) => {
    for (let y = 0; y < height; y++) {
      for (let x = 0; x < width; x++) {
        const [u, v] = [x + dx, y + dy];
        if (u < 0 || u >= width || v >= height) continue;
        found.push([y * width + x, v * width + u, weights[direction]?.[y * width + x] ?? 0]);
      }
    }
  });
  return found;
}

/** Solves A x = b by elimination. */
function eliminated(a: number[][], b: number[]): number[] {
  const rows = a.map((row, i) => [...row, b[i] as number]);
  const count = rows.length;
  for (let i = 0; i < count; i++) {
    const pivot = rows[i] as number[];
    for (let k = i + 1; k < count; k++) {
      const row = rows[k] as number[];
      const factor = (row[i] as number) / (pivot[i] as number);
      for (let c = i; c <= count; c++) row[c] = (row[c] as number) - factor * (pivot[c] as number);
    }
  }
  const x = new Array<number>(count).fill(0);
  for (let i = count - 1; i >= 0; i--) {
    const row = rows[i] as number[];
    let sum = row[count] as number;
    for (let c = i + 1; c < count; c++) sum -= (row[c] as number) * (x[c] as number);
    x[i] = sum / (row[i] as number);
  }
  return x;
}

test("the random walker solves its linear system, and stays between the priors", () => {
  for (let seed = 1; seed <= 20; seed++) {
    const numbers = new Random(seed);
    const random = () => numbers.between(0, 1);
    const [width, height] = [1 + Math.floor(7 * random()), 1 + Math.floor(7 * random())];
    const count = width * height;
    const values = (scale: number) => Float64Array.from({ length: count }, () => scale * random());
    const weights = [values(1), values(1), values(1), values(1)] as const;
    const [prior, trust] = [values(1), values(0.5).map((value) => value + 0.01)];
    const a = Array.from({ length: count }, (_, i) =>
      Array.from({ length: count }, (_, j) => (i === j ? (trust[i] as number) : 0)),
    );
    for (const [i, j, w] of pairs(width, height, weights)) {
      (a[i] as number[])[i] = (a[i]?.[i] as number) + w;
      (a[j] as number[])[j] = (a[j]?.[j] as number) + w;
      (a[i] as number[])[j] = (a[i]?.[j] as number) - w;
      (a[j] as number[])[i] = (a[j]?.[i] as number) - w;
    }
    const expected = eliminated(
      a,
      Array.from(prior, (p, i) => p * (trust[i] as number)),
    );
    const found = walked({ width, height, weights }, prior, trust, prior, 1e-10);
    for (const [i, x] of found.entries()) {
      assert.ok(Math.abs(x - (expected[i] as number)) < 1e-7, `seed ${seed}: ${x}, ${expected[i]}`);
    }
    const [low, high] = [Math.min(...prior), Math.max(...prior)];
    assert.ok(
      found.every((x) => x > low - 1e-7 && x < high + 1e-7),
      `seed ${seed}`,
    );
  }
});

test("paths are the shortest: as by relaxing all steps until nothing changes", () => {
  for (let seed = 1; seed <= 20; seed++) {
    const numbers = new Random(seed);
    const random = () => numbers.between(0, 1);
    const [width, height] = [2 + Math.floor(9 * random()), 2 + Math.floor(9 * random())];
    const costs = STEPS.map(() => Float64Array.from({ length: width * height }, () => random() + 0.01));
    const sources = [
      [0, 0.2],
      [width * height - 1, 0],
    ] as const;
    const expected = new Float64Array(width * height).fill(Number.POSITIVE_INFINITY);
    for (const [pixel, length] of sources) expected[pixel] = length;
    const all = pairs(width, height, costs);
    for (let isChanged = true; isChanged; ) {
      isChanged = false;
      for (const [i, j, cost] of all) {
        for (const [from, to] of [
          [i, j],
          [j, i],
        ] as const) {
          if ((expected[from] as number) + cost >= (expected[to] as number)) continue;
          expected[to] = (expected[from] as number) + cost;
          isChanged = true;
        }
      }
    }
    assert.deepEqual(distances({ width, height }, sources, costs), expected, `seed ${seed}`);
  }
});

/** A ball in front of a slanted table, and what a camera sees: the ball has the colours of the table in a pattern. */
function ballOnTable(hasColour: boolean) {
  const [width, height] = [160, 120];
  const truth = new Uint8Array(width * height);
  const depth = new Float32Array(width * height);
  const rgba = new Uint8ClampedArray(4 * width * height).fill(255);
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      const i = y * width + x;
      const away = Math.hypot(x - 70, y - 60) / 25;
      truth[i] = away < 1 ? 1 : 0;
      // The inverse depth of a plane is linear.
      const table = 1 / (0.8 + 0.004 * y);
      depth[i] = away < 1 ? table - 0.12 * Math.sqrt(1 - away * away) - 0.05 : table;
      const checks = (Math.floor(x / 9) + Math.floor(y / 9)) % 2 === 0 ? 90 : 150;
      rgba.set(hasColour && away < 1 ? [200, 60, 40] : [checks, checks, checks], 4 * i);
    }
  }
  return { view: { width, height, rgba, depth }, truth };
}

function iou(mask: Uint8Array, truth: Uint8Array): number {
  let [both, either] = [0, 0];
  mask.forEach((inside, i) => {
    both += inside & (truth[i] as number);
    either += inside | (truth[i] as number);
  });
  return both / either;
}

const click: Stroke = { points: [[70, 60]], radius: 1.5, adds: true };

test("one click finds an object by its colour, and by its depth where the colours are the same", () => {
  const [coloured, grey] = [ballOnTable(true), ballOnTable(false)];
  assert.ok(iou(regionOf({ ...coloured.view, depth: null }, [click]), coloured.truth) > 0.95);
  assert.ok(iou(regionOf(grey.view, [click]), grey.truth) > 0.9);
});

test("strokes are obeyed: what they cover is, or is not, in the region", () => {
  const { view, truth } = ballOnTable(true);
  const remove: Stroke = {
    points: [
      [58, 50],
      [58, 70],
    ],
    radius: 3,
    adds: false,
  };
  const add: Stroke = {
    points: [
      [120, 30],
      [130, 30],
    ],
    radius: 3,
    adds: true,
  };
  const found = regionOf({ ...view, depth: null }, [click, remove, add]);
  for (const [{ points }, expected] of [
    [remove, 0],
    [add, 1],
    [click, 1],
  ] as const) {
    for (const [x, y] of points) assert.equal(found[y * view.width + x], expected, `${x}, ${y}`);
  }
  assert.ok(found.reduce((sum, one) => sum + one, 0) < truth.length / 2);
  assert.ok(!regionOf(view, []).includes(1));
  assert.deepEqual(regionOf(view, [click]), regionOf(view, [click]));
});

test("any image and any click give a region of pixels that hang together with the clicks", () => {
  for (let seed = 1; seed <= 12; seed++) {
    const numbers = new Random(seed);
    const random = () => numbers.between(0, 1);
    const [width, height] = [1 + Math.floor(40 * random()), 1 + Math.floor(40 * random())];
    const rgba = Uint8ClampedArray.from({ length: 4 * width * height }, () => 256 * random());
    const hostile = [0, Number.NaN, Number.POSITIVE_INFINITY, -1, 1e-30, 1e30];
    const depth = Float32Array.from({ length: width * height }, () =>
      random() < 0.3 ? (hostile[Math.floor(6 * random())] as number) : 0.5 + random(),
    );
    const [x, y] = [Math.floor(width * random()), Math.floor(height * random())];
    const found = regionOf({ width, height, rgba, depth: seed % 2 === 0 ? depth : null }, [
      { points: [[x, y]], radius: 1, adds: true },
    ]);
    assert.equal(found.length, width * height);
    assert.equal(found[y * width + x], 1, `seed ${seed}`);
  }
});

test("brushes paint on a region, in order, at least the pixel that they are on", () => {
  const size = { width: 9, height: 7 };
  const mark = (x: number, radius: number, adds: boolean) => ({
    ...{ points: [[x, 3]] as [number, number][], radius, adds, followsEdges: false },
  });
  const region = new Uint8Array(63).fill(1);
  const mask = painted([mark(4, 2, false), mark(4, 0, true)], region, null, size);
  for (let y = 0; y < 7; y++) {
    for (let x = 0; x < 9; x++) {
      const isOut = Math.hypot(x - 4, y - 3) <= 2 && !(x === 4 && y === 3);
      assert.equal(mask[9 * y + x], isOut ? 0 : 1, `${x}, ${y}`);
    }
  }
  assert.ok(region.every((one) => one === 1));
});

test("triangles are counted by the headers of GLB, PLY and STL", async () => {
  const count = (path: string, content: Uint8Array, size = content.length) =>
    declaredTriangles({
      path,
      size,
      bytes: () => assert.fail("read as a whole"),
      head: async (length) => content.subarray(0, length),
    });
  const ply = Buffer.from(
    "ply\nformat binary_little_endian 1.0\nelement vertex 9\nproperty float x\nelement face 17000000\nend_header\n",
  );
  assert.equal(await count("a.ply", ply), 17_000_000);
  const stl = Buffer.alloc(4096);
  stl.writeUInt32LE(17_000_000, 80);
  assert.equal(await count("a.stl", stl, 84 + 50 * 17_000_000), 17_000_000);
  assert.equal(await count("a.stl", stl), null);
  const json = Buffer.from(
    JSON.stringify({
      accessors: [{ count: 300 }, { count: 12 }],
      meshes: [
        {
          primitives: [
            { indices: 0, attributes: {} },
            { attributes: { POSITION: 1 }, mode: 5 },
            { attributes: { POSITION: 1 }, mode: 1 },
          ],
        },
      ],
      nodes: [{ mesh: 0 }, { mesh: 0 }, {}],
    }),
  );
  const glb = Buffer.alloc(20 + json.length);
  glb.write("glTF", "latin1");
  glb.writeUInt32LE(json.length, 12);
  json.copy(glb, 20);
  assert.equal(await count("a.glb", glb), 2 * (100 + 10));
  assert.equal(await count("a.glb", glb.subarray(0, 40)), null);
  assert.equal(await count("a.obj", Buffer.from("v 0 0 0\n")), null);
});
