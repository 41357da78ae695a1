/** The mesh and the observed points for a view in 3D, in a form that is small in a file. */
import { bounds } from "../conventions/mesh.js";
import { minus } from "../conventions/rotation.js";
import { moved, similarityOf } from "../conventions/similarity.js";
import type { Picture } from "./png.js";
import type { Shot } from "./shot.js";
import type { View } from "./view.js";

/** Cells along the longest side of a mesh; vertices in a cell are joined. */
const CELLS = 44;
/** Steps of a coordinate along the longest side of what is shown. */
const STEPS = 32_000;
const MAX_POINTS = 9000;

/** Arrays in base64, little endian. */
export interface SpaceJson {
  /** The middle, camera frame, metres; coordinates are relative to it. */
  center: [number, number, number];
  /** Metres per step of the coordinates. */
  stepM: number;
  /** Int16, x, y, z per vertex. */
  vertices: string;
  /** Uint16, three per triangle. */
  triangles: string;
  /** Int16, x, y, z per point. */
  points: string;
  /** Red, green, blue per point. */
  colours: string;
}

const base64 = (array: Int16Array | Uint16Array | Uint8Array) =>
  Buffer.from(array.buffer, array.byteOffset, array.byteLength).toString("base64");

/** The content of a view: its depth map, in metres, and its picture. */
interface Seen {
  view: View;
  measured: Float32Array;
  picture: Picture;
}

/** The posed mesh, simplified, and the points of a view in the colours of a picture of it. */
export function spaceOf(shot: Shot, matrix: readonly number[], seen: Seen): SpaceJson {
  const mesh = simplified(shot, shot.ofArrays(matrix));
  const { min, max } = bounds(mesh.vertices);
  const center = min.map((low, axis) => (low + (max[axis] as number)) / 2) as SpaceJson["center"];
  const size = Math.max(...min.map((low, axis) => (max[axis] as number) - low), 1e-6);
  // Points farther than two sizes from the object are left out.
  const stepM = (2.5 * size) / STEPS;
  const quantised = (numbers: ArrayLike<number>) =>
    Int16Array.from(numbers, (x, i) => Math.round((x - (center[i % 3] as number)) / stepM));
  const { points, colours } = observed(shot, seen, center, 2 * size);
  return {
    ...{ center, stepM, vertices: base64(quantised(mesh.vertices)), triangles: base64(mesh.triangles) },
    ...{ points: base64(quantised(points)), colours: base64(Uint8Array.from(colours)) },
  };
}

/** The posed mesh with one vertex per occupied cell of a grid: the mean of the vertices in it. */
function simplified({ mesh }: Shot, matrix: readonly number[]): { vertices: Float64Array; triangles: Uint16Array } {
  const { positions } = mesh;
  const indices = mesh.indices ?? Uint32Array.from({ length: positions.length / 3 }, (_, i) => i);
  const pose = similarityOf({ matrix });
  const { min: low, max: high } = bounds(positions);
  const side = Math.max(...high.map((x, axis) => x - (low[axis] as number)), 1e-30) / CELLS;
  const vertexOfCell = new Map<number, number>();
  const sums: [x: number, y: number, z: number][] = [];
  const counts: number[] = [];
  const vertexOf = Uint32Array.from({ length: positions.length / 3 }, (_, i) => {
    const at = [0, 1, 2].map((axis) => positions[3 * i + axis] as number) as (typeof sums)[0];
    const key = at.reduce((sum, x, axis) => sum * (CELLS + 1) + Math.floor((x - (low[axis] as number)) / side), 0);
    const vertex = vertexOfCell.get(key) ?? sums.length;
    vertexOfCell.set(key, vertex);
    const sum = sums[vertex] ?? [0, 0, 0];
    sums[vertex] = [sum[0] + at[0], sum[1] + at[1], sum[2] + at[2]];
    counts[vertex] = (counts[vertex] ?? 0) + 1;
    return vertex;
  });
  const means = sums.map(([x, y, z], vertex) => {
    const count = counts[vertex] as number;
    return moved(pose, [x / count, y / count, z / count]);
  });
  const seen = new Set<string>();
  const triangles: number[] = [];
  for (let t = 0; t + 2 < indices.length; t += 3) {
    const [a = 0, b = 0, c = 0] = [0, 1, 2].map((k) => vertexOf[indices[t + k] as number] as number);
    if (a === b || b === c || c === a || Math.max(a, b, c) > 0xffff) continue;
    const key = [a, b, c].sort((i, j) => i - j).join();
    if (!seen.has(key)) triangles.push(a, b, c);
    seen.add(key);
  }
  return { vertices: Float64Array.from(means.flat()), triangles: Uint16Array.from(triangles) };
}

/** The observed points of a view near a place. */
function observed(shot: Shot, { view, measured, picture }: Seen, center: SpaceJson["center"], reachM: number) {
  const { fx, fy, cx, cy } = view.camera(shot.camera);
  const pointAt = (i: number): [x: number, y: number, z: number] => {
    const z = measured[i] as number;
    return [((i % view.width) - cx) * (z / fx), (Math.floor(i / view.width) - cy) * (z / fy), z];
  };
  const near: number[] = [];
  measured.forEach((z, i) => {
    if (z === 0) return;
    const [dx, dy, dz] = minus(pointAt(i), center);
    if (Math.hypot(dx, dy, dz) < reachM) near.push(i);
  });
  const points: number[] = [];
  const colours: number[] = [];
  const step = Math.max(1, near.length / MAX_POINTS);
  for (let k = 0; k < near.length; k += step) {
    const i = near[Math.floor(k)] as number;
    points.push(...pointAt(i));
    colours.push(...picture.data.subarray(3 * i, 3 * i + 3));
  }
  return { points, colours };
}
