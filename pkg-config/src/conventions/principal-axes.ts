/** Principal axes: the eigenvectors of symmetric matrices, and those of a mesh's surface. */

import type { Vector3 } from "../values/validation.js";
import { type Mesh, triangleCount, vertexAt } from "./mesh.js";
import {
  column,
  cross,
  determinant,
  entry,
  fromColumns,
  identity,
  type Matrix3,
  matrixOf,
  minus,
  plus,
  product,
  scaled,
  transposed,
} from "./rotation.js";

/** The centroid and the covariance of the surface, weighted by area, independent of the distribution of vertices. */
export function surfaceMoments(mesh: Mesh): { centroid: Vector3; covariance: Matrix3 } {
  let area = 0;
  let sum: Vector3 = [0, 0, 0];
  const squares = new Float64Array(9);
  for (let t = 0; t < triangleCount(mesh); t++) {
    const [a, b, c] = [vertexAt(mesh, 3 * t), vertexAt(mesh, 3 * t + 1), vertexAt(mesh, 3 * t + 2)] as const;
    const weight = Math.hypot(...cross(minus(b, a), minus(c, a))) / 2;
    const total = plus(plus(a, b), c);
    area += weight;
    sum = plus(sum, scaled(total, weight / 3));
    for (const i of axes) {
      for (const j of axes) {
        // The integral of x·y over a triangle: (Σ xᵢ·yᵢ + Σxᵢ · Σyᵢ) / 12 of its area.
        const inner = a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + total[i] * total[j];
        squares[3 * i + j] = (squares[3 * i + j] ?? 0) + (weight * inner) / 12;
      }
    }
  }
  if (area === 0) return { centroid: [0, 0, 0], covariance: identity };

  const centroid = scaled(sum, 1 / area);
  const covariance = matrixOf((i, j) => (squares[3 * i + j] ?? 0) / area - centroid[i] * centroid[j]);
  return { centroid, covariance };
}

const axes = [0, 1, 2] as const;

/** The planes of the rotations: each pair of axes. */
const planes = [[0, 1] as const, [0, 2] as const, [1, 2] as const] as const;

/** The axes along which a surface is spread most and least, as columns; right-handed. */
export const principalAxes = (mesh: Mesh): Matrix3 => eigenvectors(surfaceMoments(mesh).covariance);

/** The eigenvectors of a symmetric matrix as columns, by Jacobi rotations; right-handed. */
export function eigenvectors(symmetric: Matrix3): Matrix3 {
  let matrix = symmetric;
  let vectors = identity;
  // Three planes per sweep; the off-diagonal entries shrink quadratically.
  for (let step = 0; step < 36; step++) {
    const [p, q] = planes[(step % 3) as 0];
    const off = entry(matrix, p, q);
    if (off === 0) continue;
    const theta = (entry(matrix, q, q) - entry(matrix, p, p)) / (2 * off);
    const t = (theta < 0 ? -1 : 1) / (Math.abs(theta) + Math.sqrt(theta * theta + 1));
    const cos = 1 / Math.sqrt(t * t + 1);
    const turn: number[] = [...identity];
    [turn[4 * p], turn[4 * q], turn[3 * p + q], turn[3 * q + p]] = [cos, cos, t * cos, -t * cos];
    const rotation = turn as unknown as Matrix3;
    matrix = product(transposed(rotation), product(matrix, rotation));
    vectors = product(vectors, rotation);
  }
  if (determinant(vectors) > 0) return vectors;
  return fromColumns(column(vectors, 0), column(vectors, 1), scaled(column(vectors, 2), -1));
}
