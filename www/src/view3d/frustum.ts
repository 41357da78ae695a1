/** The frustum of the depth camera, as lines. */
import { BufferAttribute, BufferGeometry, type Color, LineBasicMaterial, LineSegments } from "three/webgpu";
import type { SceneInput } from "./types.js";

/** A pyramid from the camera centre to the image corners at a depth, in the OpenCV camera frame. */
export class Frustum {
  readonly object: LineSegments<BufferGeometry, LineBasicMaterial>;

  constructor({ camera, width, height }: SceneInput, depthM: number, color: Color) {
    const corner = (u: number, v: number) => [
      ((u - camera.cx) / camera.fx) * depthM,
      ((v - camera.cy) / camera.fy) * depthM,
      depthM,
    ];
    const [left, top, right, bottom] = [-0.5, -0.5, width - 0.5, height - 0.5];
    const corners = [corner(left, top), corner(right, top), corner(right, bottom), corner(left, bottom)];
    const lines = corners.flatMap((point, i) => [0, 0, 0, ...point, ...point, ...(corners[(i + 1) % 4] ?? point)]);
    // A triangle above the image marks the up direction.
    const apex = corner((left + right) / 2, top - 0.22 * height);
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
