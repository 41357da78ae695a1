/** The ground: a grid of lines on the plane that the objects stand on. */
import { BufferAttribute, BufferGeometry, type Color, LineBasicMaterial, LineSegments, Vector3 } from "three/webgpu";
import type { PlaneInput } from "./types.js";

/** Lines in each direction, at least. */
const LINES = 10;

/** A grid around what stands on a plane, in the OpenCV camera frame. */
export class Floor {
  readonly object: LineSegments<BufferGeometry, LineBasicMaterial>;

  constructor({ normal, d }: PlaneInput, centre: readonly [number, number, number], radiusM: number, color: Color) {
    const up = new Vector3(...normal).normalize();
    const foot = new Vector3(...centre);
    foot.addScaledVector(up, -(up.dot(foot) + d));
    // Along the image's x axis, as far as the plane allows.
    const along = new Vector3(1, 0, 0).addScaledVector(up, -up.x).normalize();
    const across = new Vector3().crossVectors(up, along);
    const spacingM = roundStep((4 * radiusM) / LINES);
    const half = spacingM * Math.ceil((2 * radiusM) / spacingM);
    const positions: number[] = [];
    const add = (a: number, b: number) =>
      positions.push(...foot.clone().addScaledVector(along, a).addScaledVector(across, b));
    for (let x = -half; x <= half + 1e-9; x += spacingM) {
      add(x, -half);
      add(x, half);
      add(-half, x);
      add(half, x);
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(Float32Array.from(positions), 3));
    const material = new LineBasicMaterial({ color, transparent: true, opacity: 0.55, depthWrite: false });
    this.object = new LineSegments(geometry, material);
  }

  dispose(): void {
    this.object.removeFromParent();
    this.object.geometry.dispose();
    this.object.material.dispose();
  }
}

/** The largest of 1, 2 and 5 times a power of ten that is not above a length. */
function roundStep(length: number): number {
  const power = 10 ** Math.floor(Math.log10(length));
  return power * (length >= 5 * power ? 5 : length >= 2 * power ? 2 : 1);
}
