/** Intrinsics from the forms that need no file reader. */
import { describe } from "../error.js";
import type { FieldOfViewCamera, MatrixCamera, PinholeCamera } from "../input/types.js";
import { failure, finiteNumbers, record } from "./numbers.js";
import type { ImageSize } from "./pixels.js";

/** A camera whose intrinsics are stated. */
export type StatedCamera = PinholeCamera | MatrixCamera | FieldOfViewCamera;

/** A pinhole camera's four numbers, checked; pixel centres are at whole numbers. */
export interface Pinhole {
  fx: number;
  fy: number;
  cx: number;
  cy: number;
}

/** The four numbers. */
export function pinholeOf(argument: string, camera: unknown, size?: ImageSize): Pinhole {
  const { K, fovYDeg, ...rest } = record(argument, camera, "{ fx, fy, cx, cy }, { K } or { fovYDeg }");
  if (K !== undefined) return checked(argument, fromMatrix(`${argument}.K`, K));
  if (fovYDeg !== undefined && size !== undefined) return checked(argument, fromFieldOfView(argument, fovYDeg, size));
  return checked(argument, rest as unknown as Pinhole);
}

function fromMatrix(argument: string, K: unknown): Pinhole {
  const numbers = finiteNumbers(argument, K, 9, "nine finite numbers, row by row");
  const [fx = 0, skew, cx = 0, b, fy = 0, cy = 0, c, d, w = 0] = numbers.map((number) => number / (numbers[8] ?? 1));
  if (w === 1 && [skew, b, c, d].every((zero) => Math.abs(zero ?? 0) <= 1e-6 * Math.abs(fx))) return { fx, fy, cx, cy };
  const remedy = "Pass K row by row; a column-major K has cx and cy in its last row: transpose it.";
  const expected = "[fx, 0, cx, 0, fy, cy, 0, 0, 1]";
  throw failure("INVALID_CAMERA", argument, `[${numbers.join(", ")}]`, expected, remedy);
}

function fromFieldOfView(argument: string, fovYDeg: unknown, { width, height }: ImageSize): Pinhole {
  if (typeof fovYDeg !== "number" || !(fovYDeg > 0 && fovYDeg < 180)) {
    const expected = "an angle above 0 and below 180 degrees";
    throw failure("INVALID_CAMERA", `${argument}.fovYDeg`, describe(fovYDeg), expected, "Pass degrees.");
  }
  const f = height / 2 / Math.tan((fovYDeg * Math.PI) / 360);
  return { fx: f, fy: f, cx: (width - 1) / 2, cy: (height - 1) / 2 };
}

function checked(argument: string, { fx, fy, cx, cy }: Pinhole): Pinhole {
  const values = Object.entries({ fx, fy, cx, cy });
  const wrong = values.find(([name, value]) => !Number.isFinite(value) || (name.startsWith("f") && value <= 0));
  if (wrong === undefined) return { fx, fy, cx, cy };
  const [name, value] = wrong;
  const expected = name.startsWith("f") ? "a finite number above 0" : "a finite number";
  const remedy = "Intrinsics are in pixels: { fx, fy, cx, cy }.";
  throw failure("INVALID_CAMERA", `${argument}.${name}`, describe(value), expected, remedy);
}
