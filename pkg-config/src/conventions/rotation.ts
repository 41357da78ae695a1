/** Vectors, 3×3 matrices, and rotations as matrices and as quaternions in either order. */
import { failure } from "../values/error.js";
import { finiteNumbers, type Quaternion, type Vector3 } from "../values/validation.js";

type Vector = Readonly<Vector3>;

/** A 3×3 matrix, row-major. */
export type Matrix3 = readonly [number, number, number, number, number, number, number, number, number];

export const dot = (a: Vector, b: Vector): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const norm = (a: Vector): number => Math.sqrt(dot(a, a));
export const scaled = (a: Vector, s: number): Vector3 => [a[0] * s, a[1] * s, a[2] * s];
export const unit = (a: Vector): Vector3 => scaled(a, 1 / norm(a));
export const plus = (a: Vector, b: Vector): Vector3 => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const minus = (a: Vector, b: Vector): Vector3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const cross = (a: Vector, b: Vector): Vector3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

/** The mean of points; the origin of none. */
export const meanOf = (points: readonly Vector[]): Vector3 =>
  scaled(points.reduce<Vector3>(plus, [0, 0, 0]), 1 / Math.max(points.length, 1));

export const identity: Matrix3 = [1, 0, 0, 0, 1, 0, 0, 0, 1];

/** A matrix whose entries are computed from row and column. */
export const matrixOf = (entry: (row: 0 | 1 | 2, column: 0 | 1 | 2) => number): Matrix3 => [
  ...([entry(0, 0), entry(0, 1), entry(0, 2)] as const),
  ...([entry(1, 0), entry(1, 1), entry(1, 2)] as const),
  ...([entry(2, 0), entry(2, 1), entry(2, 2)] as const),
];

/** An entry. */
export const entry = (m: Matrix3, row: 0 | 1 | 2, column: 0 | 1 | 2): number => m[(3 * row + column) as 0];

/** a·b. */
export const product = (a: Matrix3, b: Matrix3): Matrix3 =>
  matrixOf(
    (i, j) => entry(a, i, 0) * entry(b, 0, j) + entry(a, i, 1) * entry(b, 1, j) + entry(a, i, 2) * entry(b, 2, j),
  );

/** The transpose. */
export const transposed = (m: Matrix3): Matrix3 => matrixOf((i, j) => entry(m, j, i));

/** m·v. */
export const turned = (m: Matrix3, [x, y, z]: Readonly<Vector3>): Vector3 => [
  m[0] * x + m[1] * y + m[2] * z,
  m[3] * x + m[4] * y + m[5] * z,
  m[6] * x + m[7] * y + m[8] * z,
];

/** A column. */
export const column = (m: Matrix3, j: 0 | 1 | 2): Vector3 => [entry(m, 0, j), entry(m, 1, j), entry(m, 2, j)];

/** The matrix with these columns. */
export const fromColumns = (...columns: readonly [Vector3, Vector3, Vector3]): Matrix3 =>
  matrixOf((i, j) => columns[j][i]);

/** The determinant. */
export const determinant = (m: Matrix3): number =>
  m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);

/** The cofactor matrix: the transposed inverse times the determinant. */
export const cofactors = (m: Matrix3): Matrix3 => [
  ...([m[4] * m[8] - m[5] * m[7], m[5] * m[6] - m[3] * m[8], m[3] * m[7] - m[4] * m[6]] as const),
  ...([m[2] * m[7] - m[1] * m[8], m[0] * m[8] - m[2] * m[6], m[1] * m[6] - m[0] * m[7]] as const),
  ...([m[1] * m[5] - m[2] * m[4], m[2] * m[3] - m[0] * m[5], m[0] * m[4] - m[1] * m[3]] as const),
];

/** Maximum deviation of a matrix from a rotation, as in the core: the rounding of a few decimals in a JSON file. */
const tolerance = 1e-3;

/** The rotation nearest to an approximate rotation matrix, by polar decomposition. */
export function rotationOf(argument: string, m: Matrix3): Matrix3 {
  const square = product(transposed(m), m);
  const off = Math.max(...square.map((x, i) => Math.abs(x - (i % 4 === 0 ? 1 : 0))));
  const volume = determinant(m);
  // Written so that NaN, from squares that overflow, is rejected.
  if (!(off <= tolerance && volume > 0)) {
    const found = `a matrix with |RᵀR − 1| up to ${off} and determinant ${volume}`;
    const remedy = "A similarity has no shear, no reflection, and a uniform scale.";
    throw failure("INVALID_TRANSFORM", argument, found, "a rotation: orthonormal with determinant +1", remedy);
  }
  // Keeps the rotation of a result bit for bit.
  if (off < 1e-15) return m;
  let rotation = m;
  // Newton's iteration, which converges quadratically.
  for (let i = 0; i < 3; i++) {
    const [minors, volume] = [cofactors(rotation), determinant(rotation)];
    rotation = matrixOf((row, col) => (entry(rotation, row, col) + entry(minors, row, col) / volume) / 2);
  }
  return rotation;
}

/** The rotation matrix of a quaternion x, y, z, w of any length above 0. */
export function rotationFromQuaternion(argument: string, quaternion: unknown): Matrix3 {
  const numbers = finiteNumbers(argument, quaternion, 4, "a quaternion of four finite numbers") as Quaternion;
  const length = Math.hypot(...numbers);
  if (!(length > 1e-12)) {
    const remedy = "The identity is x, y, z, w = 0, 0, 0, 1.";
    throw failure("INVALID_TRANSFORM", argument, `[${numbers.join(", ")}]`, "a quaternion other than 0", remedy);
  }
  return rotationOfUnit(numbers.map((q) => q / length) as Quaternion);
}

/** The rotation matrix of a unit quaternion. */
export const rotationOfUnit = ([x, y, z, w]: Quaternion): Matrix3 => [
  ...([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)] as const),
  ...([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)] as const),
  ...([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)] as const),
];

/** A rotation as a unit quaternion x, y, z, w with w ≥ 0. */
export function quaternionOf(m: Matrix3): Quaternion {
  // Four times the square of each component; division by the largest preserves precision.
  const squares = [
    1 + m[0] - m[4] - m[8],
    1 - m[0] + m[4] - m[8],
    1 - m[0] - m[4] + m[8],
    1 + m[0] + m[4] + m[8],
  ] as const;
  const [xy, xz, yz] = [m[1] + m[3], m[2] + m[6], m[5] + m[7]];
  const [xw, yw, zw] = [m[7] - m[5], m[2] - m[6], m[3] - m[1]];
  const products: readonly Quaternion[] = [
    [squares[0], xy, xz, xw],
    [xy, squares[1], yz, yw],
    [xz, yz, squares[2], zw],
    [xw, yw, zw, squares[3]],
  ];
  const largest = squares.indexOf(Math.max(...squares));
  const [x, y, z, w] = products[largest] ?? [0, 0, 0, 1];
  const length = Math.hypot(x, y, z, w) * (w < 0 ? -1 : 1);
  // Adding 0 converts −0 to 0.
  return [x / length + 0, y / length + 0, z / length + 0, w / length + 0];
}

/** A quaternion x, y, z, w in the order of PyTorch3D, Blender, Eigen's constructor, COLMAP and MuJoCo. */
export const wFirst = ([x, y, z, w]: Quaternion): [w: number, x: number, y: number, z: number] => [w, x, y, z];
