/** The principal axes of a mesh's surface. */

import type { Vector3 } from "../values/values.js";
import { type Mesh, triangleCount, vertexAt } from "./mesh.js";
import { column, determinant, entry, fromColumns, type Matrix3, product, transposed } from "./rotation.js";

/** The covariance of the surface, weighted by area, independent of the distribution of vertices. */
function covariance(mesh: Mesh): Matrix3 {
  let area = 0;
  const sum: Vector3 = [0, 0, 0];
  const squares = new Float64Array(9);
  for (let t = 0; t < triangleCount(mesh); t++) {
    const corners = [vertexAt(mesh, 3 * t), vertexAt(mesh, 3 * t + 1), vertexAt(mesh, 3 * t + 2)] as const;
    const [a, b, c] = corners;
    const [u, v] = [b.map((x, k) => x - (a[k] ?? 0)), c.map((x, k) => x - (a[k] ?? 0))] as [Vector3, Vector3];
    const weight = Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2;
    const total = a.map((x, k) => x + (b[k] ?? 0) + (c[k] ?? 0)) as Vector3;
    area += weight;
    for (const i of [0, 1, 2] as const) {
      sum[i] += (weight * total[i]) / 3;
      for (const j of [0, 1, 2] as const) {
        // The integral of x·y over a triangle: (Σ xᵢ·yᵢ + Σxᵢ · Σyᵢ) / 12 of its area.
        const own = corners.reduce((all, corner) => all + corner[i] * corner[j], 0);
        squares[3 * i + j] = (squares[3 * i + j] ?? 0) + (weight * (own + total[i] * total[j])) / 12;
      }
    }
  }
  if (area === 0) return [1, 0, 0, 0, 1, 0, 0, 0, 1];
  return Array.from(squares, (square, k) => {
    const [i, j] = [Math.floor(k / 3) as 0, (k % 3) as 0];
    return square / area - (sum[i] / area) * (sum[j] / area);
  }) as unknown as Matrix3;
}

/** The planes of the rotations: each pair of axes. */
const planes = [[0, 1] as const, [0, 2] as const, [1, 2] as const] as const;

/** The axes along which a surface is spread most and least, as columns; right-handed. */
export const principalAxes = (mesh: Mesh): Matrix3 => eigenvectors(covariance(mesh));

/** The eigenvectors of a symmetric matrix as columns, by Jacobi rotations; right-handed. */
export function eigenvectors(symmetric: Matrix3): Matrix3 {
  let matrix = symmetric;
  let axes: Matrix3 = [1, 0, 0, 0, 1, 0, 0, 0, 1];
  // Three planes per sweep; the off-diagonal entries shrink quadratically.
  for (let step = 0; step < 36; step++) {
    const [p, q] = planes[(step % 3) as 0];
    const off = entry(matrix, p, q);
    if (off === 0) continue;
    const theta = (entry(matrix, q, q) - entry(matrix, p, p)) / (2 * off);
    const t = (theta < 0 ? -1 : 1) / (Math.abs(theta) + Math.sqrt(theta * theta + 1));
    const cos = 1 / Math.sqrt(t * t + 1);
    const turn = [1, 0, 0, 0, 1, 0, 0, 0, 1];
    [turn[4 * p], turn[4 * q], turn[3 * p + q], turn[3 * q + p]] = [cos, cos, t * cos, -t * cos];
    const rotation = turn as unknown as Matrix3;
    matrix = product(transposed(rotation), product(matrix, rotation));
    axes = product(axes, rotation);
  }
  const [x, y, z] = [column(axes, 0), column(axes, 1), column(axes, 2)];
  return determinant(axes) < 0 ? fromColumns(x, y, [-z[0], -z[1], -z[2]]) : axes;
}
