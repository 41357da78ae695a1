/** Rotation of spherical harmonics, in the order and with the signs of 3D Gaussian Splatting. */
import type { Vector3 } from "../values/validation.js";
import { type Matrix3, transposed, turned } from "./rotation.js";

/** The harmonics of each degree from 1 on, at a unit vector: real, orthonormal, m from −l to l, odd m negative. */
const harmonics: readonly ((direction: Readonly<Vector3>) => readonly number[])[] = [
  ([x, y, z]) => [-0.4886025119029199 * y, 0.4886025119029199 * z, -0.4886025119029199 * x],
  ([x, y, z]) => [
    1.0925484305920792 * x * y,
    -1.0925484305920792 * y * z,
    0.31539156525252005 * (2 * z * z - x * x - y * y),
    -1.0925484305920792 * x * z,
    0.5462742152960396 * (x * x - y * y),
  ],
  ([x, y, z]) => [
    -0.5900435899266435 * y * (3 * x * x - y * y),
    2.890611442640554 * x * y * z,
    -0.4570457994644658 * y * (4 * z * z - x * x - y * y),
    0.3731763325901154 * z * (2 * z * z - 3 * x * x - 3 * y * y),
    -0.4570457994644658 * x * (4 * z * z - x * x - y * y),
    1.445305721320277 * z * (x * x - y * y),
    -0.5900435899266435 * x * (x * x - 3 * y * y),
  ],
];

/** The highest degree that can be rotated. */
export const MAX_DEGREE = harmonics.length;

/** The nodes above 0 of the Gauss–Legendre quadrature with four nodes, and their weights. */
const legendre = [
  [0.3399810435848563, 0.6521451548625461],
  [0.8611363115940526, 0.34785484513745385],
] as const;

/** Directions and weights that integrate polynomials of degree 7 over the sphere exactly: more than products of these. */
const quadrature = legendre
  .flatMap(([z, weight]) => [[z, weight] as const, [-z, weight] as const])
  .flatMap(([z, weight]) =>
    Array.from({ length: 8 }, (_, i) => {
      const [angle, radius] = [(i * Math.PI) / 4, Math.sqrt(1 - z * z)];
      const direction: Vector3 = [radius * Math.cos(angle), radius * Math.sin(angle), z];
      return { direction, weight: (weight * Math.PI) / 4 };
    }),
  );

/**
 * The matrix (rows, Wigner's D of real harmonics) that turns the coefficients of one degree, 1 to {@link MAX_DEGREE}: the
 * function of the turned coefficients at R·d is that of the given ones at d.
 */
export function harmonicRotation(degree: number, rotation: Matrix3): number[][] {
  const at = harmonics[degree - 1] as (typeof harmonics)[number];
  const back = transposed(rotation);
  const matrix = Array.from({ length: 2 * degree + 1 }, () => new Array<number>(2 * degree + 1).fill(0));
  for (const { direction, weight } of quadrature) {
    const [turnedTo, from] = [at(direction), at(turned(back, direction))];
    matrix.forEach((row, i) => {
      from.forEach((value, j) => {
        row[j] = (row[j] ?? 0) + weight * (turnedTo[i] ?? 0) * value;
      });
    });
  }
  return matrix;
}
