/** The frustum of the depth camera, as lines. */
import { BufferAttribute, BufferGeometry, type Color, LineBasicMaterial, LineSegments } from "three/webgpu";
import type { SceneInput } from "./types.js";

/** A pyramid from the camera centre to the image corners at a depth, in the OpenCV camera frame. */
export class Frustum {
  readonly object: LineSegments<BufferGeometry, LineBasicMaterial>;

  constructor(scene: SceneInput, depthM: number, color: Color) {
    const { width, height } = scene;
    const corners = imageCorners(scene, depthM);
    const lines = corners.flatMap((point, i) => [0, 0, 0, ...point, ...point, ...(corners[(i + 1) % 4] ?? point)]);
    // A triangle above the image marks the up direction.
    const apex = pointAt(scene, width / 2 - 0.5, -0.5 - 0.22 * height, depthM);
    lines.push(...(corners[0] ?? apex), ...apex, ...apex, ...(corners[1] ?? apex));
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(Float32Array.from(lines), 3));
    this.object = new LineSegments(geometry, new LineBasicMaterial({ color }));
  }

  dispose(): void {
    this.object.removeFromParent();
    this.object.geometry.dispose();
    this.object.material.dispose();
  }
}

/** The corners of the image at a depth, clockwise from the upper left one. */
export function imageCorners(scene: SceneInput, depthM: number): number[][] {
  const [right, bottom] = [scene.width - 0.5, scene.height - 0.5];
  const corners = [
    [-0.5, -0.5],
    [right, -0.5],
    [right, bottom],
    [-0.5, bottom],
  ] as const;
  return corners.map(([u, v]) => pointAt(scene, u, v, depthM));
}

const pointAt = ({ camera }: SceneInput, u: number, v: number, depthM: number) => [
  ((u - camera.cx) / camera.fx) * depthM,
  ((v - camera.cy) / camera.fy) * depthM,
  depthM,
];
