/** Finds the mesh or point under the pointer. */
import type { Group, PerspectiveCamera } from "three/webgpu";
import type { Cloud } from "./cloud.js";
import type { Model } from "./model.js";
import { Matrix4, Raycaster, Vector2 } from "./three.js";
import type { SceneInput } from "./types.js";

/** Radius around the pointer in which points are picked, in CSS pixels. */
const reachPx = 5;

/** The picked mesh or point. */
export interface Picked {
  /** The id of the mesh; undefined for a point of the cloud. */
  id?: string;
  /** OpenCV camera frame, metres. */
  point: [number, number, number];
  /** The pixel of the depth map. */
  pixel: { x: number; y: number } | null;
}

/** A place in a view, and the size of the view; CSS pixels. */
interface Aim {
  place: { x: number; y: number };
  size: { width: number; height: number };
}

/** What can be picked. The children of `root` are in the OpenCV camera frame. */
interface Pickable {
  camera: PerspectiveCamera;
  root: Group;
  models: readonly Model[];
  cloud: Cloud | null;
  scene: SceneInput | null;
}

/** The nearest mesh or point. */
export function pick({ place, size }: Aim, { camera, root, models, cloud, scene }: Pickable): Picked | null {
  if (!scene) return null;
  camera.updateMatrixWorld();
  root.updateMatrixWorld();
  const mesh = pickMesh({ place, size }, camera, models);
  const clip = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
  clip.multiply(root.matrixWorld);
  const point = cloud && pickPoint(cloud.points.positions, clip.elements, place, size, reachPx);
  if (mesh && !(point && point.distance < 0.99 * mesh.distance)) {
    const { x, y, z } = root.worldToLocal(mesh.point.clone());
    return { id: mesh.id, point: [x, y, z], pixel: pixelOf([x, y, z], scene) };
  }
  if (!point || !cloud) return null;
  const { positions, pixels } = cloud.points;
  const [x = 0, y = 0, z = 0] = positions.subarray(3 * point.index);
  const pixel = pixels[point.index] ?? 0;
  return { point: [x, y, z], pixel: { x: pixel % scene.width, y: Math.floor(pixel / scene.width) } };
}

function pickMesh({ place, size }: Aim, camera: PerspectiveCamera, models: readonly Model[]) {
  const ray = new Raycaster();
  ray.setFromCamera(new Vector2((2 * place.x) / size.width - 1, 1 - (2 * place.y) / size.height), camera);
  const hits = models
    .filter(({ pivot }) => pivot.visible)
    .flatMap((model) => {
      const hit = model.intersect(ray);
      return hit ? [{ id: model.id, point: hit.point, along: hit.distance }] : [];
    });
  const [first] = hits.sort((a, b) => a.along - b.along);
  if (!first) return null;
  return { ...first, distance: -first.point.clone().applyMatrix4(camera.matrixWorldInverse).z };
}

/** Extra cost of a point at the border of the radius, as a share of its distance. */
const BORDER_PENALTY = 0.1;

/** A point under the pointer. */
interface Hit {
  /** Index of the point. */
  index: number;
  /** Distance along the viewing direction, metres (w in clip space). */
  distance: number;
}

/**
 * The nearest point within a radius around a place on the screen.
 *
 * @param positions interleaved x, y, z
 * @param clip clip space from the frame of the points, column-major
 * @param at pixels from the left and top
 * @param size of the screen in pixels
 */
export function pickPoint(
  positions: Float32Array,
  clip: ArrayLike<number>,
  at: { x: number; y: number },
  size: { width: number; height: number },
  radiusPx: number,
): Hit | null {
  const row = (i: number) => [clip[i] ?? 0, clip[i + 4] ?? 0, clip[i + 8] ?? 0, clip[i + 12] ?? 0] as const;
  const [ax, ay, az, aw] = row(0);
  const [bx, by, bz, bw] = row(1);
  const [dx, dy, dz, dw] = row(3);
  const wantedX = (2 * at.x) / size.width - 1;
  const wantedY = 1 - (2 * at.y) / size.height;
  const [radiusX, radiusY] = [(2 * radiusPx) / size.width, (2 * radiusPx) / size.height];
  let best: Hit | null = null;
  let bestCost = Number.POSITIVE_INFINITY;
  for (let i = 0; i < positions.length; i += 3) {
    const [x, y, z] = [positions[i] as number, positions[i + 1] as number, positions[i + 2] as number];
    const w = dx * x + dy * y + dz * z + dw;
    if (w <= 0 || w >= bestCost) continue;
    const [offX, offY] = [(ax * x + ay * y + az * z + aw) / w - wantedX, (bx * x + by * y + bz * z + bw) / w - wantedY];
    const off = Math.max(Math.abs(offX) / radiusX, Math.abs(offY) / radiusY);
    // Of the points of one surface, this prefers the one closest to the pointer.
    const cost = w * (1 + BORDER_PENALTY * off);
    if (off > 1 || cost >= bestCost) continue;
    bestCost = cost;
    best = { index: i / 3, distance: w };
  }
  return best;
}

/** The pixel of a point in the OpenCV camera frame; `null` behind the camera or outside the image. */
export function pixelOf(
  [x, y, z]: readonly [number, number, number],
  { camera, width, height }: Pick<SceneInput, "camera" | "width" | "height">,
): { x: number; y: number } | null {
  if (!(z > 0)) return null;
  // Adding 0 turns −0 into 0.
  const [u, v] = [Math.round((camera.fx * x) / z + camera.cx) + 0, Math.round((camera.fy * y) / z + camera.cy) + 0];
  return u >= 0 && v >= 0 && u < width && v < height ? { x: u, y: v } : null;
}
