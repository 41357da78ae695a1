/** Colours at points of a surface. */
import { cross, dot, minus } from "../conventions/rotation.js";
import { rgbOf } from "../input/colors.js";
import type { ColorSamples } from "../types/files.js";
import type { Vector3 } from "../values/validation.js";

/** Number of points: as many as those of mesh files. */
const COUNT = 32_768;

/** Steps of a sequence that fills a square evenly: the inverse powers of the root of x³ = x + 1. */
const STEPS = [0.7548776662466927, 0.5698402909980532] as const;

/** Writes the linear colour of a triangle to `out`, at the point with these weights of its second and third corner. */
export type ColorAt = (triangle: number, second: number, third: number, out: Float64Array) => void;

/**
 * Points spread evenly by area over a mesh, with outward normals and their colours; undefined for a mesh without area.
 */
export function surfaceSamples(
  positions: Float32Array,
  indices: Uint32Array,
  colorAt: ColorAt,
): ColorSamples | undefined {
  const ends = new Float64Array(indices.length / 3);
  let [area, volume] = [0, 0];
  for (let t = 0; t < ends.length; t++) {
    const { a, normal } = triangleOf(positions, indices, t);
    area += Math.sqrt(dot(normal, normal));
    volume += dot(a, normal);
    ends[t] = area;
  }
  if (!(area > 0 && Number.isFinite(area))) return undefined;
  const samples = { positions: new Float32Array(3 * COUNT), normals: new Float32Array(3 * COUNT) };
  const colors = new Float32Array(3 * COUNT);
  const color = new Float64Array(3);
  const facing = volume < 0 ? -1 : 1;
  let t = 0;
  for (let k = 0; k < COUNT; k++) {
    const at = ((k + 0.5) / COUNT) * area;
    while (t < ends.length - 1 && (ends[t] as number) <= at) t++;
    const { a, b, c, normal } = triangleOf(positions, indices, t);
    let [second, third] = STEPS.map((step) => (k * step) % 1) as [number, number];
    if (second + third > 1) [second, third] = [1 - second, 1 - third];
    colorAt(t, second, third, color);
    const length = Math.sqrt(dot(normal, normal)) || 1;
    for (let axis = 0; axis < 3; axis++) {
      const [x = 0, y = 0, z = 0] = [a[axis], b[axis], c[axis]];
      samples.positions[3 * k + axis] = x + (y - x) * second + (z - x) * third;
      samples.normals[3 * k + axis] = ((normal[axis] as number) / length) * facing;
      colors[3 * k + axis] = color[axis] as number;
    }
  }
  return { ...samples, colors: rgbOf(colors, 3, "linear") };
}

/** The corners of a triangle, and its normal with the length of twice its area. */
function triangleOf(positions: Float32Array, indices: Uint32Array, t: number) {
  const [a, b, c] = [0, 1, 2].map((corner) => {
    const first = 3 * (indices[3 * t + corner] as number);
    return [positions[first], positions[first + 1], positions[first + 2]] as Vector3;
  }) as [Vector3, Vector3, Vector3];
  return { a, b, c, normal: cross(minus(b, a), minus(c, a)) };
}
