/** Labels of lengths in the view. */
import { CanvasTexture, Sprite, SpriteMaterial } from "three/webgpu";

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
  if (context !== null) {
    context.font = "600 34px system-ui, sans-serif";
    const width = context.measureText(text).width + 32;
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
  return sprite;
}

export function removeLabel(label: Sprite): void {
  label.removeFromParent();
  label.material.map?.dispose();
  label.material.dispose();
}
