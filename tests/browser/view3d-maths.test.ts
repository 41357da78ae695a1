/** The parts of the 3D view that need no graphics, in Node. */
import assert from "node:assert/strict";
import { join } from "node:path";
import { before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { build } from "esbuild";
import { repository } from "../support/environment.js";

type Numbers = ArrayLike<number>;
interface Points {
  positions: Float32Array;
  pixels: Uint32Array;
  stride: number;
}
/** The exports of the bundle below. */
interface Maths {
  between(from: Numbers, to: Numbers, share: number, centre: readonly number[]): Float64Array;
  pointsOf(scene: object, most: number): Points;
  extentOf(points: Points, isMember: (pixel: number) => boolean): { centre: number[]; radius: number };
  pickPoint(positions: Float32Array, clip: Numbers, at: object, size: object, reach: number): { index: number } | null;
  pixelOf(point: readonly number[], scene: object): { x: number; y: number } | null;
}

const entry = `
  import { Vector3 } from "three/webgpu";
  import { between as betweenPoses, matrixOf, poseOf } from "./pose.ts";
  export { extentOf, pointsOf } from "./points.ts";
  export { pickPoint, pixelOf } from "./picker.ts";
  export const between = (from, to, share, centre) =>
    matrixOf(betweenPoses(poseOf(from), poseOf(to), share, new Vector3(...centre)));
`;

let maths: Maths;
before(async () => {
  const outfile = join(repository, "target", "view3d-test", "maths.mjs");
  await build({
    stdin: { contents: entry, resolveDir: join(repository, "www", "src", "view3d") },
    ...{ bundle: true, format: "esm", platform: "node", outfile, logLevel: "error" },
    alias: { "sim3align/conventions": join(repository, "pkg", "conventions.js") },
  });
  maths = (await import(pathToFileURL(outfile).href)) as Maths;
});

const camera = { fx: 50, fy: 45, cx: 7.2, cy: 5.9 };
const scene = (depth: (u: number, v: number) => number, width = 16, height = 12) => ({
  ...{ width, height, camera },
  depthM: Float32Array.from({ length: width * height }, (_, i) => depth(i % width, Math.floor(i / width))),
});

/** A column-major pose, rotated about z. */
function pose(scale: number, turnDeg: number, [x, y, z]: readonly [number, number, number]): number[] {
  const [c, s] = [Math.cos((turnDeg * Math.PI) / 180) * scale, Math.sin((turnDeg * Math.PI) / 180) * scale];
  return [c, s, 0, 0, -s, c, 0, 0, 0, 0, scale, 0, x, y, z, 1];
}

const isClose = (found: Numbers, wanted: Numbers, within = 1e-9) =>
  assert.ok(
    Array.from(wanted).every((x, i) => Math.abs((found[i] ?? Number.NaN) - x) <= within),
    `${Array.from(found)} is not ${Array.from(wanted)}`,
  );

test("interpolated poses: both ends, geometric scale, constant rotation, centre on a straight line", () => {
  const [from, to] = [pose(0.1, 10, [0.3, 0, 1]), pose(0.4, 130, [-0.2, 0.5, 2])];
  const centre = [4, -1, 2];
  isClose(maths.between(from, to, 0, centre), from);
  isClose(maths.between(from, to, 1, centre), to);
  const middle = maths.between(from, to, 0.5, centre);
  const [cos = 0, sin = 0] = middle;
  isClose([Math.hypot(cos, sin), (Math.atan2(sin, cos) * 180) / Math.PI], [0.2, 70]);
  const applied = (m: Numbers) =>
    [0, 1, 2].map((k) => [0, 1, 2].reduce((sum, c) => sum + (m[4 * c + k] ?? 0) * (centre[c] ?? 0), m[12 + k] ?? 0));
  const [start, end] = [applied(from), applied(to)];
  isClose(
    applied(middle),
    start.map((x, k) => (x + (end[k] ?? 0)) / 2),
  );
});

test("points of a depth map project to their pixels, and pixels without depth give no points", () => {
  const input = scene((u, v) =>
    u === 3 ? 0 : u === 4 ? Number.NaN : u === 5 ? Number.POSITIVE_INFINITY : 1 + 0.1 * v,
  );
  const { positions, pixels, stride } = maths.pointsOf(input, 1000);
  assert.deepEqual([pixels.length, positions.length, stride], [13 * 12, 3 * 13 * 12, 1]);
  pixels.forEach((pixel, i) => {
    const at = maths.pixelOf(Array.from(positions.subarray(3 * i, 3 * i + 3)), input);
    assert.deepEqual(at, { x: pixel % 16, y: Math.floor(pixel / 16) });
  });
  assert.equal(maths.pixelOf([0, 0, -1], input), null);
  assert.equal(maths.pixelOf([10, 0, 1], input), null);
  const thinned = maths.pointsOf(input, 50);
  assert.ok(thinned.stride === 2 && thinned.pixels.length <= 50, `${thinned.stride}, ${thinned.pixels.length}`);
});

test("the centre of the points of a mask is robust against outliers", () => {
  const points = maths.pointsOf(
    scene((u) => (u === 2 ? 9 : 1)),
    1000,
  );
  const { centre, radius } = maths.extentOf(points, (pixel) => pixel % 16 > 1);
  assert.ok(Math.abs((centre[2] ?? 0) - 1) < 1e-6 && radius < 0.4, `${centre}, ${radius}`);
  const all = maths.extentOf(points, () => false);
  isClose(all.centre, maths.extentOf(points, () => true).centre);
});

test("picking prefers the point under the pointer, unless another one is clearly nearer", () => {
  // Clip space of a camera that looks along +z of these points, 90° wide: w = z.
  const clip = [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0];
  const size = { width: 100, height: 100 };
  const wall = Float32Array.from({ length: 3 * 100 }, (_, i) => [(Math.floor(i / 3) - 50) / 50, 0, 1][i % 3] ?? 0);
  const at = (x: number, y = 50) => maths.pickPoint(wall, clip, { x, y }, size, 4)?.index;
  assert.deepEqual([at(0), at(20), at(51), at(99)], [0, 20, 51, 99]);
  assert.equal(at(50, 60), undefined);
  const before = Float32Array.of(...wall, 0.53 * 0.5, 0, 0.5, 0, 0, -1);
  assert.equal(maths.pickPoint(before, clip, { x: 75, y: 50 }, size, 4)?.index, 100);
  assert.equal(maths.pickPoint(before, clip, { x: 50, y: 50 }, size, 1)?.index, 50);
});
