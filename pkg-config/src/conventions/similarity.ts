/** Conversions and operations of similarity transforms. */

import type { Sim3, Sim3Like } from "../input/sim3.js";
import { checkAttached, plainArgument } from "../values/border.js";
import { describe, failure } from "../values/error.js";
import { isRecord, isTypedArray } from "../values/kinds.js";
import { finiteNumbers, flattened, type Vector3, vector3, wrongKind } from "../values/validation.js";
import {
  determinant,
  entry,
  type Matrix3,
  product,
  quaternionOf,
  rotationFromQuaternion,
  rotationOf,
  transposed,
  turned,
} from "./rotation.js";

/** A validated similarity y = s·R·x + t. */
export interface Similarity {
  scale: number;
  rotation: Matrix3;
  translation: Vector3;
}

/** Validates a similarity in any of its forms. */
export function similarityOf(transform: unknown, argument = "transform"): Similarity {
  if (!isRecord(transform)) return fromColumnMajor(argument, transform);
  const { matrix, scale, rotation, rotationMatrix, translation } = plainArgument(argument, transform);
  if (scale === undefined && matrix !== undefined) return fromColumnMajor(`${argument}.matrix`, matrix);
  if (typeof scale !== "number" || !(Number.isFinite(scale) && scale > 0)) {
    const remedy = "Pass { scale, rotation, translation }, a result of align, or a column-major 4×4 matrix.";
    throw failure("INVALID_TRANSFORM", `${argument}.scale`, describe(scale), "a finite number above 0", remedy);
  }
  return {
    scale,
    // A result has both; the matrix is exact.
    rotation: rotationFrom(`${argument}.rotation`, rotationMatrix ?? rotation),
    translation: vector3(`${argument}.translation`, translation),
  };
}

function rotationFrom(argument: string, value: unknown): Matrix3 {
  const expected = "a quaternion x, y, z, w, or nine numbers, row-major";
  if (flattened(value)?.length === 4) return rotationFromQuaternion(argument, value);
  return rotationOf(argument, finiteNumbers(argument, value, 9, expected) as unknown as Matrix3);
}

function fromColumnMajor(argument: string, value: unknown): Similarity {
  const expected = "{ scale, rotation, translation }, or a column-major 4×4 matrix of 16 numbers";
  const m = finiteNumbers(argument, value, 16, expected);
  const [a = 0, b = 0, c = 0, last0, d = 0, e = 0, f = 0, last1, g = 0, h = 0, i = 0, last2, x = 0, y = 0, z = 0] = m;
  const last = [last0, last1, last2, m[15]];
  if (last.some((number, k) => Math.abs((number ?? 0) - (k === 3 ? 1 : 0)) > 1e-9)) {
    const remedy = "Elements 12 to 14 are the translation. Transpose a row-major matrix.";
    throw failure("INVALID_TRANSFORM", argument, `last row [${last.join(", ")}]`, "last row [0, 0, 0, 1]", remedy);
  }
  const linear: Matrix3 = [a, d, g, b, e, h, c, f, i];
  const scale = Math.cbrt(Math.abs(determinant(linear)));
  if (!(Number.isFinite(scale) && scale > 0)) {
    throw failure("INVALID_TRANSFORM", argument, `scale ${scale}`, "a finite scale above 0", "Pass a similarity.");
  }
  const rotation = linear.map((number) => number / scale) as unknown as Matrix3;
  return { scale, rotation: rotationOf(argument, rotation), translation: [x, y, z] };
}

/** Converts a similarity to all forms. */
export function sim3Of({ scale, rotation, translation }: Similarity): Sim3 {
  const [a, b, c, d, e, f, g, h, i] = rotation;
  const columns = [a, d, g, 0, b, e, h, 0, c, f, i, 0].map((number) => scale * number + 0);
  return {
    scale,
    rotation: quaternionOf(rotation),
    rotationMatrix: [
      [a, b, c],
      [d, e, f],
      [g, h, i],
    ],
    translation: [...translation],
    matrix: [...columns, ...translation, 1],
  };
}

/** The composition: b first, then a. */
export const composed = (a: Similarity, b: Similarity): Similarity => ({
  scale: a.scale * b.scale,
  rotation: product(a.rotation, b.rotation),
  translation: moved(a, b.translation),
});

/** s·R·x + t. */
export function moved({ scale, rotation, translation }: Similarity, point: Readonly<Vector3>): Vector3 {
  const [x, y, z] = turned(rotation, point);
  return [scale * x + translation[0], scale * y + translation[1], scale * z + translation[2]];
}

/** The inverse. */
export function inverted({ scale, rotation, translation }: Similarity): Similarity {
  const back = transposed(rotation);
  const [x, y, z] = turned(back, translation);
  return { scale: 1 / scale, rotation: back, translation: [-x / scale + 0, -y / scale + 0, -z / scale + 0] };
}

/**
 * Converts a similarity to all the forms in a result of `align`: `scale`, `rotation` (quaternion x, y, z, w),
 * `rotationMatrix` (rows), `translation`, and `matrix` (4×4, column-major).
 *
 * @example
 * toSim3({ scale: 2, rotation: [0, 0, 0, 1], translation: [0, 0, 1] }).matrix;    // 16 numbers, column-major
 * @throws {@link Sim3AlignError} `INVALID_TRANSFORM`, `WRONG_LENGTH`, `NON_FINITE` or `INVALID_ARGUMENT` if the
 * transform is not a similarity: for example for a reflection, a shear, or a non-uniform scale
 */
export const toSim3 = (transform: Sim3Like): Sim3 => sim3Of(similarityOf(transform));

/**
 * The **row-major** 4×4 matrix: 16 numbers, as in NumPy (`np.reshape(m, (4, 4))`), ROS and Open3D. Frames are
 * unchanged.
 *
 * @example
 * const rows = toRowMajor(result);    // rows[3], rows[7], rows[11] are the translation
 * @throws {@link Sim3AlignError} as {@link toSim3}
 */
export function toRowMajor(transform: Sim3Like): Float64Array {
  const { matrix } = toSim3(transform);
  return Float64Array.from(matrix, (_, i) => matrix[4 * (i % 4) + Math.floor(i / 4)] ?? 0);
}

/**
 * Composes transforms in the order of matrix multiplication, the last one applied first: `compose(worldFromCamera,
 * cameraFromMesh)` is `worldFromMesh`.
 *
 * @throws {@link Sim3AlignError} as {@link toSim3}
 */
export function compose(...transforms: readonly [Sim3Like, ...Sim3Like[]]): Sim3 {
  const [first, ...rest] = transforms.map((transform, i) => similarityOf(transform, `transforms[${i}]`));
  if (first === undefined) {
    throw failure("INVALID_ARGUMENT", "transforms", "nothing", "one transform or more", "Pass the transforms.");
  }
  return sim3Of(rest.reduce(composed, first));
}

/**
 * Inverts a transform: `cameraFromMesh` becomes `meshFromCamera`.
 *
 * @throws {@link Sim3AlignError} as {@link toSim3}
 */
export const invert = (transform: Sim3Like): Sim3 => sim3Of(inverted(similarityOf(transform)));

/**
 * Applies a transform to points: s·R·p + t for each.
 *
 * @param points interleaved x, y, z in the source frame of the transform; not modified
 * @returns a new array of the same type, in the target frame of the transform
 *
 * @example
 * const verticesInCamera = applyToPoints(result, mesh.positions);    // metres, OpenCV camera frame
 * @throws {@link Sim3AlignError} as {@link toSim3}; `WRONG_LENGTH` if the length is not a multiple of 3
 */
export function applyToPoints<T extends Float32Array | Float64Array>(transform: Sim3Like, points: T): T {
  const similarity = similarityOf(transform);
  if (!isTypedArray<T>(points, "Float32Array", "Float64Array")) {
    throw wrongKind("points", points, "a Float32Array or a Float64Array, x, y, z per point", "Float32Array");
  }
  checkAttached("points", points);
  if (points.length % 3 !== 0) {
    const remedy = "Pass three numbers per point.";
    throw failure("WRONG_LENGTH", "points", `${points.length} numbers`, "x, y, z per point", remedy);
  }
  const result = points.slice() as T;
  const { scale, rotation, translation } = similarity;
  const row = (i: 0 | 1 | 2) =>
    [scale * entry(rotation, i, 0), scale * entry(rotation, i, 1), scale * entry(rotation, i, 2)] as const;
  const [[a, b, c], [d, e, f], [g, h, k]] = [row(0), row(1), row(2)];
  const [tx, ty, tz] = translation;
  for (let i = 0; i < points.length; i += 3) {
    const [x, y, z] = [points[i] ?? 0, points[i + 1] ?? 0, points[i + 2] ?? 0];
    result[i] = a * x + b * y + c * z + tx;
    result[i + 1] = d * x + e * y + f * z + ty;
    result[i + 2] = g * x + h * y + k * z + tz;
  }
  return result;
}
