/** A ring around a point of the scene, with a constant size on the screen. */
import { CanvasTexture, Sprite, SpriteMaterial } from "three/webgpu";

/** The height of the ring as a share of the view, for a field of view of 90°. */
const SIZE = 0.045;

/** Marks the hovered point, in the OpenCV camera frame. */
export class Marker {
  readonly object: Sprite;

  constructor() {
    const map = new CanvasTexture(ring(64));
    // Visible through meshes.
    this.object = new Sprite(new SpriteMaterial({ map, sizeAttenuation: false, depthTest: false, depthWrite: false }));
    this.object.scale.setScalar(SIZE);
    this.object.renderOrder = 1;
    this.object.visible = false;
  }

  set point(point: readonly [number, number, number] | null) {
    this.object.visible = point !== null;
    if (point !== null) this.object.position.set(...point);
  }

  dispose(): void {
    this.object.removeFromParent();
    this.object.material.map?.dispose();
    this.object.material.dispose();
  }
}

/** A white circle with dark edges, visible on every background. */
function ring(size: number): HTMLCanvasElement {
  const canvas = document.createElement("canvas");
  canvas.width = size;
  canvas.height = size;
  const context = canvas.getContext("2d");
  if (context === null) return canvas;
  for (const [colour, width] of [
    ["#10141a", 0.26],
    ["#ffffff", 0.12],
  ] as const) {
    context.strokeStyle = colour;
    context.lineWidth = width * size;
    context.beginPath();
    context.arc(size / 2, size / 2, 0.35 * size, 0, 2 * Math.PI);
    context.stroke();
  }
  return canvas;
}
