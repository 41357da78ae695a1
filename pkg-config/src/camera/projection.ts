/** Projection matrices of renderers: OpenGL, Direct3D, Vulkan, Unity. */

/** The part of a projection from camera to clip coordinates that depends on the lens, and the sign of z in front of the camera. */
type Lens = readonly [x: number, shiftX: number, y: number, shiftY: number, forward: number];

/** Places of the numbers that are 0 in sixteen numbers by rows. */
const zeros = [1, 3, 4, 7, 8, 9, 12, 13, 15];

const transposed = (numbers: readonly number[]): number[] =>
  numbers.map((_, i) => numbers[4 * (i % 4) + Math.floor(i / 4)] as number);

function lensOf(numbers: readonly number[]): Lens | undefined {
  const at = (i: number) => numbers[i] as number;
  // Unity's Perception writes the upper left part, whose last number is about -1.
  if (numbers.length === 9) {
    const isUnity = Math.abs(at(8) + 1) < 0.01 && [1, 3, 6, 7].every((i) => at(i) === 0);
    return isUnity ? [at(0), at(2), at(4), at(5), -1] : undefined;
  }
  const isProjection = numbers.length === 16 && Math.abs(at(14)) === 1 && zeros.every((i) => at(i) === 0);
  return isProjection ? [at(0), at(2), at(5), at(6), at(14)] : undefined;
}

/**
 * The intrinsics of a projection matrix, by rows or by columns, as a matrix in image sizes, counted from the edge of the first
 * pixel. `undefined` for any other matrix.
 */
export function projectionOf(numbers: readonly number[]): number[] | undefined {
  const lens = lensOf(numbers) ?? (numbers.length === 16 ? lensOf(transposed(numbers)) : undefined);
  if (lens === undefined) return undefined;
  const [x, shiftX, y, shiftY, forward] = lens;
  const [cx, cy] = [0.5 + 0.5 * forward * shiftX, 0.5 - 0.5 * forward * shiftY * Math.sign(y)];
  const isLens = x > 0 && x < 40 && y !== 0 && Math.abs(y) < 40 && [cx, cy].every((place) => place > 0 && place < 1);
  return isLens ? [0.5 * x, 0, cx, 0, 0.5 * Math.abs(y), cy, 0, 0, 1] : undefined;
}
