/** The points of a depth map and their colours. Independent of three.js. */
import type { SceneInput } from "./types.js";

/** Neighbours whose depths differ by more than this share are on different surfaces. */
const discontinuity = 0.05;

/** Points in the OpenCV camera frame. */
export interface Points {
  /** Interleaved x, y, z, metres. */
  positions: Float32Array;
  /** The pixel of each point, as a row-major index. */
  pixels: Uint32Array;
  /** Every `stride`-th row and column is used. */
  stride: number;
}

const isReading = (z: number) => z > 0 && z < Number.POSITIVE_INFINITY;

/** The points of all pixels with a reading, subsampled to about `maxPoints`. */
export function pointsOf({ depthM, width, height, camera }: SceneInput, maxPoints: number): Points {
  let readings = 0;
  for (let i = 0; i < depthM.length; i++) if (isReading(depthM[i] as number)) readings++;
  const stride = Math.max(1, Math.ceil(Math.sqrt(readings / maxPoints)));
  const positions = new Float32Array(3 * readings);
  const pixels = new Uint32Array(readings);
  let count = 0;
  for (let v = 0; v < height; v += stride) {
    for (let u = 0; u < width; u += stride) {
      const z = depthM[v * width + u] ?? 0;
      if (!isReading(z)) continue;
      positions[3 * count] = ((u - camera.cx) / camera.fx) * z;
      positions[3 * count + 1] = ((v - camera.cy) / camera.fy) * z;
      positions[3 * count + 2] = z;
      pixels[count++] = v * width + u;
    }
  }
  return { positions: positions.slice(0, 3 * count), pixels: pixels.slice(0, count), stride };
}

/**
 * The quantile of sorted numbers.
 */
export const quantile = (numbers: ArrayLike<number>, share: number) =>
  numbers[Math.min(numbers.length - 1, Math.floor(share * numbers.length))] ?? 0;

/** A sorted subsample of the depths. */
export function sortedDepths({ positions }: Points): Float32Array {
  const every = Math.max(1, Math.floor(positions.length / 3 / 20_000));
  const depths = new Float32Array(Math.ceil(positions.length / 3 / every));
  for (let i = 0; i < depths.length; i++) depths[i] = positions[3 * i * every + 2] ?? 0;
  return depths.sort();
}

/** The median of points, and the radius around it that contains 90 % of them. */
export interface Extent {
  centre: [number, number, number];
  radius: number;
}

/** The robust extent of the points of some pixels, or of all points if those have none. */
export function extentOf({ positions, pixels }: Points, isMember: (pixel: number) => boolean): Extent {
  const members: number[] = [];
  pixels.forEach((pixel, i) => {
    if (isMember(pixel)) members.push(i);
  });
  if (members.length === 0 && pixels.length > 0) return extentOf({ positions, pixels, stride: 1 }, () => true);
  const median = (axis: number) =>
    quantile(Float32Array.from(members, (i) => positions[3 * i + axis] ?? 0).sort(), 0.5);
  const centre: Extent["centre"] = [median(0), median(1), median(2)];
  const distance = (i: number) => Math.hypot(...centre.map((median, axis) => (positions[3 * i + axis] ?? 0) - median));
  return { centre, radius: quantile(Float32Array.from(members, distance).sort(), 0.9) };
}

/** Red, green, blue from 0 to 1. */
export type Rgb = readonly [number, number, number];

/**
 * The sRGB colours of the points, four bytes each: those of the photo or, without one, from `near` to `far` by depth,
 * shaded by the surface normal.
 */
export function tonesOf(scene: SceneInput, points: Points, near: Rgb, far: Rgb): Uint8Array {
  const { pixels, positions } = points;
  const tones = new Uint8Array(4 * pixels.length).fill(255);
  if (scene.rgba) {
    for (let i = 0; i < pixels.length; i++) {
      const from = 4 * (pixels[i] as number);
      tones.set(scene.rgba.subarray(from, from + 3), 4 * i);
    }
    return tones;
  }
  const depths = sortedDepths(points);
  const [first, last] = [quantile(depths, 0.02), quantile(depths, 0.98)];
  for (let i = 0; i < pixels.length; i++) {
    const share = Math.min(1, Math.max(0, ((positions[3 * i + 2] as number) - first) / (last - first || 1)));
    const light = 255 * lightAt(scene, pixels[i] as number);
    for (let k = 0; k < 3; k++) {
      const tone = (near[k] as number) + ((far[k] as number) - (near[k] as number)) * share;
      tones[4 * i + k] = Math.min(255, light * tone + 0.5);
    }
  }
  return tones;
}

/** Brightness of the surface at a pixel. Its normal is estimated from the neighbouring depths. */
function lightAt(scene: SceneInput, pixel: number): number {
  const { fx, fy } = scene.camera;
  const z = scene.depthM[pixel] as number;
  // The normal of z = z0 + a·u + b·v, up to perspective, with x and y in metres.
  const nx = (slopeAt(scene, pixel, 1, 0) * fx) / z;
  const ny = (slopeAt(scene, pixel, 0, 1) * fy) / z;
  // Light from above, from the left and from the camera. The normal is (nx, ny, −1), with y down.
  const facing = (0.62 - 0.35 * nx - 0.7 * ny) / Math.sqrt(nx * nx + ny * ny + 1);
  return 0.62 + 0.42 * Math.max(-0.4, Math.min(1, facing));
}

/** Slope of the depth per pixel in a direction; 0 if both neighbours are missing or on other surfaces. */
function slopeAt({ depthM, width, height }: SceneInput, pixel: number, du: number, dv: number): number {
  const u = pixel % width;
  const v = (pixel - u) / width;
  const z = depthM[pixel] as number;
  // Two pixels away, because differences of adjacent pixels are mostly noise.
  const isInside = (k: number) => u + k * du >= 0 && u + k * du < width && v + k * dv >= 0 && v + k * dv < height;
  const depthAt = (k: number) => (isInside(k) ? (depthM[pixel + k * (du + dv * width)] as number) : 0);
  const [before, after] = [depthAt(-2), depthAt(2)];
  const hasBefore = before > 0 && Math.abs(before - z) < discontinuity * z;
  const hasAfter = after > 0 && Math.abs(after - z) < discontinuity * z;
  if (!hasBefore && !hasAfter) return 0;
  return ((hasAfter ? after : z) - (hasBefore ? before : z)) / (hasBefore && hasAfter ? 4 : 2);
}
