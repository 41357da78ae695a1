/** A ring about a place of the scene, as large on the screen from wherever one looks. */
import { CanvasTexture, Sprite, SpriteMaterial } from "three/webgpu";

/** Its height as a part of the view's, seen through a camera whose field of view is 90°. */
const SIZE = 0.045;

/** Where somebody points, in the OpenCV camera frame. */
export class Mark {
  readonly object: Sprite;

  constructor() {
    const map = new CanvasTexture(ring(64));
    // Never hidden: it says where something is, also behind a mesh.
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

/** Light between two dark circles, so that it is seen on everything. */
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
