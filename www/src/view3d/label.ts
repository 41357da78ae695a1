/** Labels of lengths in the view. */
import { CanvasTexture, type PerspectiveCamera, Sprite, SpriteMaterial, Vector3 } from "three/webgpu";

/** The height of a label as a share of the view, for a field of view of 90°. */
const LABEL = 0.03;

/** A length in centimetres, or metres from one metre on. */
export function lengthText(m: number): string {
  return m >= 1 ? `${m.toFixed(2)} m` : `${(100 * m).toFixed(m < 0.1 ? 2 : 1)} cm`;
}

/** A text that faces the viewer, in the same size at every distance. */
export function labelOf(text: string): Sprite {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [256, 64];
  const context = canvas.getContext("2d");
  /** The share of the canvas that the text takes. */
  let share = 1;
  if (context !== null) {
    context.font = "600 34px system-ui, sans-serif";
    const width = context.measureText(text).width + 32;
    share = Math.min(width / 256, 1);
    context.fillStyle = "rgb(16 20 26 / 82%)";
    context.beginPath();
    context.roundRect((256 - width) / 2, 6, width, 52, 14);
    context.fill();
    context.fillStyle = "#ffffff";
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillText(text, 128, 33);
  }
  const map = new CanvasTexture(canvas);
  const sprite = new Sprite(new SpriteMaterial({ map, sizeAttenuation: false, depthTest: false, depthWrite: false }));
  sprite.scale.set(4 * LABEL, LABEL, 1);
  sprite.renderOrder = 3;
  sprite.userData.share = share;
  return sprite;
}

/** Moves labels that would overlap below one another, as seen from the camera. */
export function spreadLabels(labels: readonly Sprite[], camera: PerspectiveCamera): void {
  const [across = 1, , , , , down = 1] = camera.projectionMatrix.elements;
  const seen = labels.map((label) => ({ label, at: label.getWorldPosition(new Vector3()).project(camera) }));
  const placed: { x: number; y: number; width: number }[] = [];
  for (const { label, at } of seen.sort((a, b) => b.at.y - a.at.y)) {
    const height = label.scale.y * down;
    const width = label.scale.x * across * (label.userData.share as number);
    const overlaps = (y: number) =>
      placed.find((other) => Math.abs(other.x - at.x) < (other.width + width) / 2 && Math.abs(other.y - y) < height);
    let y = at.y;
    // Each step is below one of the others, so there are at most as many.
    for (let other = overlaps(y); other !== undefined; other = overlaps(y)) y = other.y - 1.02 * height;
    label.center.set(0.5, 0.5 + (at.y - y) / height);
    placed.push({ x: at.x, y, width });
  }
}

export function removeLabel(label: Sprite): void {
  label.removeFromParent();
  label.material.map?.dispose();
  label.material.dispose();
}
