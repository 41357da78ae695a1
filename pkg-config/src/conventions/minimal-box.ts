/** The axes of a small oriented box around a mesh. */

import type { Vector3 } from "../values/validation.js";
import type { Mesh } from "./mesh.js";
import { principalAxes } from "./principal-axes.js";
import {
  column,
  cross,
  dot,
  fromColumns,
  identity,
  type Matrix3,
  minus,
  norm,
  plus,
  scaled,
  unit,
} from "./rotation.js";

type Point2 = readonly [number, number];

/** The vertices of triangles that are extreme in one of many directions; all vertices if there are few. */
export function outermost({ positions, indices }: Mesh): Vector3[] {
  const used = indices === null ? Array.from({ length: positions.length / 3 }, (_, i) => i) : [...new Set(indices)];
  const vertex = (i: number): Vector3 => [positions[3 * i] ?? 0, positions[3 * i + 1] ?? 0, positions[3 * i + 2] ?? 0];
  if (used.length <= 2000) return used.map(vertex);
  const kept = new Set<number>();
  // Directions through a grid on half of the surface of a cube; each finds two extreme vertices.
  const steps = Array.from({ length: 13 }, (_, i) => (i - 6) / 6);
  const directions = steps.flatMap((a) =>
    steps.flatMap((b): Vector3[] => [
      [1, a, b],
      [a, 1, b],
      [a, b, 1],
    ]),
  );
  // Flat numbers: meshes may have a million vertices.
  const points = new Float32Array(3 * used.length);
  used.forEach((from, i) => {
    points.set(positions.subarray(3 * from, 3 * from + 3), 3 * i);
  });
  for (const [x, y, z] of directions) {
    let [low, high] = [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
    let [first, last] = [0, 0];
    for (let i = 0; i < points.length; i += 3) {
      const along = x * (points[i] as number) + y * (points[i + 1] as number) + z * (points[i + 2] as number);
      if (along < low) {
        low = along;
        first = i;
      }
      if (along > high) {
        high = along;
        last = i;
      }
    }
    kept.add(first / 3).add(last / 3);
  }
  return Array.from(kept, (i) => vertex(used[i] ?? 0));
}

/** The corners of the convex hull, counter-clockwise (Andrew's monotone chain). */
function hull(points: readonly Point2[]): Point2[] {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (ordered: readonly Point2[]) => {
    const chain: Point2[] = [];
    for (const point of ordered) {
      for (;;) {
        const [a, b] = chain.slice(-2);
        if (a === undefined || b === undefined) break;
        if ((b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0]) > 0) break;
        chain.pop();
      }
      chain.push(point);
    }
    return chain.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())];
}

/** The difference of the largest and the smallest of numbers, of which there are at most as many as outermost points. */
const spread = (numbers: readonly number[]): number => Math.max(...numbers) - Math.min(...numbers);

/** The extent of points along a direction in the plane. */
const width = (points: readonly Point2[], x: number, y: number): number =>
  spread(points.map(([a, b]) => a * x + b * y));

/**
 * The direction of the smallest rectangle around points. One of its sides lies along an edge of their convex hull, unless its
 * area is not below this share of that along the axes.
 */
export function smallestRectangle(points: readonly Point2[], tighter = 1): { cos: number; sin: number; area: number } {
  const corners = hull(points);
  const own = { cos: 1, sin: 0, area: width(corners, 1, 0) * width(corners, 0, 1) };
  let best = { ...own, area: tighter * own.area };
  corners.forEach(([x, y], i) => {
    const [nextX, nextY] = corners[(i + 1) % corners.length] ?? [x, y];
    const length = Math.hypot(nextX - x, nextY - y);
    if (length === 0) return;
    const [cos, sin] = [(nextX - x) / length, (nextY - y) / length];
    const area = width(corners, cos, sin) * width(corners, -sin, cos);
    if (area < best.area) best = { cos, sin, area };
  });
  return best.sin === 0 ? own : best;
}

/** The least side of a box, relative to the longest: the boxes of a flat mesh have no volume, but an area. */
const THIN = 1e-6;

function volume(points: readonly Vector3[], axes: readonly Vector3[]): number {
  const sides = axes.map((axis) => spread(points.map((point) => dot(axis, point))));
  const thin = THIN * Math.max(...sides);
  return sides.reduce((product, side) => product * Math.max(side, thin), 1);
}

type Axes = [Vector3, Vector3, Vector3];

/** Rotates the axes about each of them to the smallest rectangle, until the volume no longer decreases. */
function refined(points: readonly Vector3[], start: Axes): { axes: Axes; volume: number } {
  let axes = start;
  let size = volume(points, axes);
  for (let round = 0; round < 20; round++) {
    const before = size;
    for (const k of [0, 1, 2] as const) {
      const [a, b] = [axes[((k + 1) % 3) as 0], axes[((k + 2) % 3) as 0]];
      const { cos, sin } = smallestRectangle(points.map((point) => [dot(a, point), dot(b, point)]));
      const turned: Axes = [...axes];
      turned[((k + 1) % 3) as 0] = plus(scaled(a, cos), scaled(b, sin));
      turned[((k + 2) % 3) as 0] = plus(scaled(a, -sin), scaled(b, cos));
      const turnedSize = volume(points, turned);
      if (turnedSize < size) [axes, size] = [turned, turnedSize];
    }
    if (!(size < before * (1 - 1e-9))) break;
  }
  return { axes, volume: size };
}

/**
 * Permutes and flips the axes so that they are nearest to the axes of the mesh (largest trace). The result is never a
 * reflection: reflections have a trace of at most 1, and some rotation always has more than 1.9.
 */
function named(axes: Axes): Matrix3 {
  const orders = [
    [0, 1, 2],
    [1, 2, 0],
    [2, 0, 1],
    [0, 2, 1],
    [2, 1, 0],
    [1, 0, 2],
  ] as const;
  const ways = orders.map((order) => {
    const [x, y, z] = order.map((i, k) => {
      const axis = axes[i];
      return (axis[k] ?? 0) < 0 ? scaled(axis, -1) : axis;
    }) as Axes;
    return fromColumns(x, y, z);
  });
  const trace = (m: Matrix3) => m[0] + m[4] + m[8];
  return ways.reduce((best, way) => (trace(way) > trace(best) ? way : best));
}

/** Cells per unit along the axes in which normals count as one. */
const CELLS = 8;

/** Axes along the normal of most of the surface, and along that of most of the rest. */
function faceAxes({ positions, indices }: Mesh): Axes | undefined {
  const count = indices?.length ?? positions.length / 3;
  const sums = new Map<string, Vector3>();
  for (let i = 0; i + 2 < count; i += 3) {
    const [a, b, c] = [0, 1, 2].map((k): Vector3 => {
      const at = 3 * (indices?.[i + k] ?? i + k);
      return [positions[at] ?? 0, positions[at + 1] ?? 0, positions[at + 2] ?? 0];
    }) as [Vector3, Vector3, Vector3];
    const normal = cross(minus(b, a), minus(c, a));
    const length = norm(normal);
    if (!(length > 0)) continue;
    // Opposite sides have one normal.
    const first = normal.find((x) => Math.abs(x) > length / 4) ?? 1;
    const side = scaled(normal, Math.sign(first));
    const cell = side.map((x) => Math.round((CELLS * x) / length)).join();
    sums.set(cell, plus(sums.get(cell) ?? [0, 0, 0], side));
  }
  const all = [...sums.values()];
  const largest = (normals: readonly Vector3[]) =>
    normals.reduce<Vector3>((best, normal) => (norm(normal) > norm(best) ? normal : best), [0, 0, 0]);
  const x = largest(all);
  if (norm(x) === 0) return undefined;
  const across = (normal: Vector3) => minus(normal, scaled(x, dot(normal, x) / dot(x, x)));
  const y = largest(all.map(across));
  if (norm(y) < 1e-6 * norm(x)) return undefined;
  const [first, second] = [unit(x), unit(y)];
  return [first, second, cross(first, second)];
}

/** The axes of the smallest box found, as columns in the mesh frame. */
export function smallestBoxAxes(mesh: Mesh): Matrix3 {
  const points = outermost(mesh);
  const columns = (start: Matrix3): Axes => [column(start, 0), column(start, 1), column(start, 2)];
  const faces = faceAxes(mesh);
  const starts = [columns(identity), columns(principalAxes(mesh)), ...(faces === undefined ? [] : [faces])];
  const found = starts.map((start) => refined(points, start));
  // Keeps the axes of the mesh unless others are better by more than rounding errors.
  return named(found.reduce((best, next) => (next.volume < best.volume * (1 - 1e-9) ? next : best)).axes);
}
