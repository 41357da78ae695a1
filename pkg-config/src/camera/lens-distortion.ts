/** Lens distortion: how far a camera is from a pinhole. */
import { isNumber } from "../values/json.js";
import type { ImageSize } from "../values/pixels.js";
import type { Pinhole } from "./pinhole.js";

/** The distortion that a camera file states. */
export interface Distortion {
  /** The keys that state it, in the words of the file. */
  keys: readonly string[];
  /** The name of the model, such as `plumb_bob`, `OPENCV_FISHEYE` or `equidistant`. */
  model: string;
  /** The coefficients in OpenCV's order: k1, k2, p1, p2, k3, k4, k5, k6; of a fisheye lens k1 to k4. */
  coefficients: readonly number[];
}

/** Models of lenses that map angles to distances. */
export const isFisheye = (model: string) => /fish|equidist|kannala|kb4|^fov$|ftheta|f-theta/i.test(model);

/** Models that are far from any pinhole. */
export const isNoPerspective = (model: string) =>
  /omni|\bmei\b|eucm|unified|^ds$|double.?sphere|scaramuzza|ocam|equirect|spheric|panoram|ortho|cylind/i.test(model);

/** Displacement in pixels that no one will notice. */
const MIN_DISPLACEMENT = 0.003;

/** Points of the image, along a side, at which the displacement is computed. */
const STEPS = 9;

/** Why the pinhole model is not that of the camera, with the size of the error; `undefined` if it is, within a few thousandths of
 * the image. */
export function distortionOf(
  { keys, model, coefficients }: Distortion,
  camera: Pinhole,
  size: ImageSize | undefined,
): string | undefined {
  const isFish = isFisheye(model);
  if (!isFish && coefficients.every((coefficient) => coefficient === 0)) return undefined;
  const { width, height } = size ?? { width: 2 * camera.cx + 1, height: 2 * camera.cy + 1 };
  const at = (i: number, side: number) => (i / (STEPS - 1)) * (side - 1);
  const points = Array.from({ length: STEPS * STEPS }, (_, i) => {
    const [u, v] = [at(i % STEPS, width), at(Math.floor(i / STEPS), height)];
    const [x, y] = [(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy];
    const [dx, dy] = isFish ? displacedByAngle(x, y, coefficients) : displaced(x, y, coefficients);
    return Math.hypot(dx * camera.fx, dy * camera.fy);
  });
  const largest = Math.max(...points);
  if (largest < MIN_DISPLACEMENT * Math.max(width, height)) return undefined;
  const [kind, places] = [isFish ? "a fisheye lens" : "lens distortion", keys.join(", ")];
  const extent =
    isNumber(largest) && largest < Math.max(width, height) ? `about ${Math.ceil(largest)} pixels` : "many pixels";
  return `The camera has ${kind} (${places}), which is not modelled: a pinhole is off by up to ${extent} in the image. Pass a rectified depth map, mask and photo, and their K.`;
}

/** The displacement of a point at z = 1 by OpenCV's model: radial, rational and tangential. */
function displaced(x: number, y: number, coefficients: readonly number[]): [number, number] {
  const [k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0, k4 = 0, k5 = 0, k6 = 0] = coefficients;
  const r2 = x * x + y * y;
  const radial = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1 + r2 * (k4 + r2 * (k5 + r2 * k6))) - 1;
  return [x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y];
}

/** The displacement of a point at z = 1 by a fisheye lens: θ (1 + k1 θ² + k2 θ⁴ + …) instead of tan θ. */
function displacedByAngle(x: number, y: number, [k1 = 0, k2 = 0, k3 = 0, k4 = 0]: readonly number[]): [number, number] {
  const r = Math.hypot(x, y);
  if (r === 0) return [0, 0];
  const angle = Math.atan(r);
  const t2 = angle * angle;
  const factor = (angle * (1 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4))))) / r - 1;
  return [x * factor, y * factor];
}
