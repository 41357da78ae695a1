/** Intrinsics of an image of another size: by how much they have to be scaled. */
import { doubtOfSize } from "sim3align/camera/pinhole";
import type { ImageSize } from "sim3align/values/pixels";
import type { CameraSource } from "../state/inputs.js";
import type { Scene } from "../state/scene.js";

/** How much larger one image of a camera usually is than another one. */
const usual = [1 / 4, 1 / 3, 3 / 8, 1 / 2, 2 / 3, 3 / 4, 4 / 3, 3 / 2, 2, 8 / 3, 3, 4];
/** How far principal points are from the middle, relative. */
const TOLERANCE = 0.08;

/** The factor that brings the principal point to the middle, if intrinsics seem to be those of an image of another size. */
export function otherSize(camera: Scene["camera"], size: ImageSize): number | null {
  if (doubtOfSize(camera, size) === undefined) return null;
  const factors = [size.width / (2 * camera.cx + 1), size.height / (2 * camera.cy + 1)];
  const isNear = (factor: number) => factors.every((one) => Math.abs(one / factor - 1) < TOLERANCE);
  return usual.find(isNear) ?? null;
}

/** Intrinsics scaled by a factor. Pixel centres are at integers. */
export const scaled = ({ fx, fy, cx, cy }: Scene["camera"], factor: number): CameraSource => ({
  ...{ kind: "numbers", fx: factor * fx, fy: factor * fy },
  ...{ cx: factor * (cx + 0.5) - 0.5, cy: factor * (cy + 0.5) - 0.5 },
});
