/** Pinhole intrinsics from four numbers, a matrix, or a field of view. */
import { describe, failure, invalidArgument } from "../values/error.js";
import type { ImageSize } from "../values/pixels.js";
import { finiteNumbers, flattened, part } from "../values/validation.js";

/** Pinhole intrinsics in pixels; pixel centres have integer coordinates. */
export interface Pinhole {
  fx: number;
  fy: number;
  cx: number;
  cy: number;
}

const forms = "{ fx, fy, cx, cy }, { K } or { fovYDeg }";
const pixels = "Intrinsics are in pixels of the depth image: scale them together with the image.";

/**
 * The intrinsics of a camera in any of these forms.
 * @param argument the name of the camera in errors
 * @param size the size of the image; only a field of view needs it
 */
export function pinholeOf(argument: string, camera: unknown, size?: ImageSize): Pinhole {
  const { K, fovYDeg, fx, fy, cx, cy } = part(argument, camera, forms);
  if (K !== undefined) return fromMatrix(argument, K);
  if (fovYDeg === undefined) return checkedPinhole(argument, { fx, fy, cx, cy });
  if (size !== undefined) return fromFieldOfView(argument, fovYDeg, size);
  throw invalidArgument(argument, camera, "{ fx, fy, cx, cy } or { K }", "A field of view requires the image size.");
}

/** Validates four numbers. */
export function checkedPinhole(argument: string, intrinsics: Record<keyof Pinhole, unknown>): Pinhole {
  for (const [name, value] of Object.entries(intrinsics)) {
    if (typeof value !== "number") throw invalidArgument(`${argument}.${name}`, value, "a number", pixels);
    const isFocalLength = name.startsWith("f");
    if (Number.isFinite(value) && (value > 0 || !isFocalLength)) continue;
    const expected = isFocalLength ? "a finite number above 0" : "a finite number";
    const remedy = isFocalLength && value < 0 ? "Images with y up have a negative fy: pass its amount." : pixels;
    throw failure("INVALID_CAMERA", `${argument}.${name}`, `${value}`, expected, remedy);
  }
  return intrinsics as Pinhole;
}

/** The intrinsics of an image that is resized as a whole. */
export function resizedPinhole({ fx, fy, cx, cy }: Pinhole, from: ImageSize, to: ImageSize): Pinhole {
  const [x, y] = [to.width / from.width, to.height / from.height];
  return { fx: fx * x, fy: fy * y, cx: (cx + 0.5) * x - 0.5, cy: (cy + 0.5) * y - 0.5 };
}

/** Skew that moves no pixel by more is left out, pixels. */
export const MAX_SKEW_PX = 0.5;

/** Matrices whose zeros are as small, relative to the focal length, are upright. */
const ZERO = 1e-6;

/**
 * Intrinsics from a 3×3 matrix, row-major, up to a common factor. Skew is left out where it moves pixels by less than half a
 * pixel; more of it is refused.
 */
export function fromMatrix(argument: string, K: unknown): Pinhole {
  const { camera, skewPx } = skewedMatrix(argument, K);
  if (skewPx <= MAX_SKEW_PX) return camera;
  const remedy = "Pass rectified images and the K of these.";
  throw failure(
    "INVALID_CAMERA",
    `${argument}.K`,
    `a skew that moves pixels by ${skewPx.toFixed(1)}`,
    "no skew",
    remedy,
  );
}

/** Intrinsics from a 3×3 matrix, row-major, up to a common factor, and by how many pixels its skew moves a pixel at most. */
export function skewedMatrix(argument: string, K: unknown): { camera: Pinhole; skewPx: number } {
  const name = `${argument}.K`;
  const numbers = flattened(K) ?? [];
  const isNumeric = numbers.length === 9 && numbers.every((number) => typeof number === "number");
  // Reports a wrong length or non-numeric elements.
  if (!isNumeric) finiteNumbers(name, K, 9, "9 numbers, row-major");
  const [fx = 0, skew = 0, cx = 0, b = 0, fy = 0, cy = 0, c = 0, d = 0, w = 0] = numbers as number[];
  const areZero = (...zeros: number[]) => zeros.every((zero) => Math.abs(zero) <= ZERO * Math.abs(fx));
  if (areZero(b, c, d) && Number.isFinite(w) && w !== 0) {
    const camera = checkedPinhole(argument, { fx: fx / w, fy: fy / w, cx: cx / w, cy: cy / w });
    // At the border of an image with this centre.
    return { camera, skewPx: areZero(skew) ? 0 : Math.abs(((skew / w) * camera.cy) / camera.fy) };
  }
  const isTransposed = areZero(skew, cx, cy) && w !== 0;
  const remedy = isTransposed
    ? "cx and cy are in the last row: transpose the matrix, K is row-major."
    : "Pass K row-major: focal lengths on the diagonal, the principal point in the last column.";
  throw failure("INVALID_CAMERA", name, `[${numbers.join(", ")}]`, "[fx, 0, cx, 0, fy, cy, 0, 0, 1]", remedy);
}

/** Intrinsics from a vertical field of view in degrees: square pixels, centred principal point. */
export function fromFieldOfView(argument: string, fovYDeg: unknown, { width, height }: ImageSize): Pinhole {
  const f = focalOfAngle(`${argument}.fovYDeg`, fovYDeg, height);
  return { fx: f, fy: f, cx: 0.5 * (width - 1), cy: 0.5 * (height - 1) };
}

/** The focal length in pixels of a field of view in degrees across `side` pixels. */
export function focalOfAngle(name: string, angleDeg: unknown, side: number): number {
  const remedy = "Pass the vertical field of view in degrees, like PerspectiveCamera.fov of three.js.";
  if (typeof angleDeg !== "number") throw invalidArgument(name, angleDeg, "a number", remedy);
  if (!(angleDeg > 0 && angleDeg < 180)) {
    throw failure("INVALID_CAMERA", name, describe(angleDeg), "an angle above 0 and below 180 degrees", remedy);
  }
  const [sin, cos] = sinCos(0.5 * (angleDeg * (Math.PI / 180)));
  return (0.5 * side * cos) / sin;
}

/** π/2 as the sum of two numbers, the first with 33 bits. */
const halfPi = [1.5707963267341256, 6.077100506506192e-11] as const;

/** Polynomials of fdlibm (`k_sin.c`, `k_cos.c`), highest power first; the core uses the same in `geometry/angle.rs`. */
const sinPolynomial = [
  ...[1.58969099521155e-10, -2.5050760253406863e-8, 2.7557313707070068e-6],
  ...[-1.984126982985795e-4, 8.33333333332249e-3, -1.6666666666666632e-1],
];
const cosPolynomial = [
  ...[-1.1359647557788195e-11, 2.087572321298175e-9, -2.7557314351390663e-7],
  ...[2.480158728947673e-5, -1.388888888887411e-3, 4.16666666666666e-2],
];

/**
 * Sine and cosine of an angle from 0 to π/2. The last bits of `Math.sin` differ between engines, but a field of view
 * must give the same alignment in all of them.
 */
function sinCos(angle: number): [sin: number, cos: number] {
  const quarters = angle > Math.PI / 4 ? 1 : 0;
  const x = angle - quarters * halfPi[0] - quarters * halfPi[1];
  const z = x * x;
  const at = (polynomial: readonly number[]) => polynomial.reduce((sum, coefficient) => sum * z + coefficient, 0);
  const half = 0.5 * z;
  const whole = 1 - half;
  const sin = x + x * z * at(sinPolynomial);
  const cos = whole + (1 - whole - half + z * z * at(cosPolynomial));
  return quarters === 0 ? [sin, cos] : [cos, -sin];
}

/**
 * The depth z along the optical axis, of distances d from the camera's centre as ray tracers and LiDAR write them:
 * z = d / √(1 + x² + y²), x = (u − cx)/fx, y = (v − cy)/fy.
 * @param distances row-major, times `scale` metres
 */
export function depthOfRays(
  distances: ArrayLike<number>,
  width: number,
  { fx, fy, cx, cy }: Pinhole,
  scale = 1,
): Float32Array {
  return Float32Array.from(distances, (distance, i) => {
    const [x, y] = [((i % width) - cx) / fx, (Math.floor(i / width) - cy) / fy];
    return (distance * scale) / Math.sqrt(1 + x * x + y * y);
  });
}
