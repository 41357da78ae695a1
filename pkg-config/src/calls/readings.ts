/** The readings of a view, in and around its mask. */
import { metresPerUnit } from "../input/depth.js";
import type { CoreFrame } from "../modules/core-input.js";
import type { Vector3 } from "../values/validation.js";

/** A pixel with a reading. */
export interface Reading {
  u: number;
  v: number;
  /** Depth, in the unit of the view. */
  z: number;
  isMasked: boolean;
}

/** The most readings of a view that are looked at. */
const MOST = 20_000;

/**
 * The readings of a view in the bounding box of its mask, which is enlarged by a share of its sides: of many, some that are
 * evenly spread. Empty without a mask or a depth map.
 */
export function readingsAround(view: CoreFrame, margin: number): Reading[] {
  const { depth, pointMap, mask } = view;
  const [width, height] = [Number(view.width), Number(view.height)];
  if (mask === undefined || (depth === undefined && pointMap === undefined)) return [];
  const [maskWidth, maskHeight] = [view.maskWidth ?? width, view.maskHeight ?? height];
  const isMasked = (u: number, v: number) => {
    const [x, y] = [Math.floor(((u + 0.5) * maskWidth) / width), Math.floor(((v + 0.5) * maskHeight) / height)];
    return (mask[y * maskWidth + x] ?? 0) > 0;
  };
  const depthAt = (i: number) => Number(depth?.[i] ?? pointMap?.[3 * i + 2]);

  let [left, right, top, bottom] = [width, -1, height, -1];
  for (let v = 0; v < height; v++) {
    for (let u = 0; u < width; u++) {
      if (!isMasked(u, v)) continue;
      [left, right] = [Math.min(left, u), Math.max(right, u)];
      [top, bottom] = [Math.min(top, v), Math.max(bottom, v)];
    }
  }
  const [across, down] = [Math.ceil(margin * (right - left + 1)), Math.ceil(margin * (bottom - top + 1))];
  [left, right] = [Math.max(0, left - across), Math.min(width - 1, right + across)];
  [top, bottom] = [Math.max(0, top - down), Math.min(height - 1, bottom + down)];

  const step = Math.max(1, Math.ceil(Math.sqrt(((right - left + 1) * (bottom - top + 1)) / MOST)));
  const readings: Reading[] = [];
  for (let v = top; v <= bottom; v += step) {
    for (let u = left; u <= right; u += step) {
      const z = depthAt(v * width + u);
      if (z > 0 && Number.isFinite(z)) readings.push({ u, v, z, isMasked: isMasked(u, v) });
    }
  }
  return readings;
}

/** The middle of the readings in the mask and their extent, in the frame of the camera; `undefined` without any. */
export function objectSeen(view: CoreFrame): { middle: Vector3; extent: number } | undefined {
  const { camera, pointMap, depthScale } = view;
  const unit = metresPerUnit(view.depth, depthScale);
  const points = readingsAround(view, 0)
    .filter(({ isMasked }) => isMasked)
    .map(({ u, v, z }): Vector3 => {
      const i = 3 * (v * Number(view.width) + u);
      if (pointMap !== undefined) return [pointMap[i] as number, pointMap[i + 1] as number, z];
      const { fx = 1, fy = 1, cx = 0, cy = 0 } = camera ?? {};
      return [((u - cx) / fx) * z * unit, ((v - cy) / fy) * z * unit, z * unit];
    });
  if (points.length === 0) return undefined;
  const sorted = [0, 1, 2].map((axis) => points.map((point) => point[axis] as number).sort((a, b) => a - b));
  const at = (share: number) => sorted.map((values) => values[Math.floor(share * (values.length - 1))] as number);
  // Some readings at the outline are of the background.
  const [low, high] = [at(0.05), at(0.95)];
  return { middle: at(0.5) as Vector3, extent: Math.hypot(...high.map((x, axis) => x - (low[axis] as number))) };
}
