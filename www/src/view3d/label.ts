/** Pictures that face the viewer, in one size at every distance and visible through meshes: labels of lengths, and a mark. */
import type { PerspectiveCamera } from "three/webgpu";
import { depth, size, type Unit } from "../ui/texts.js";
import { CanvasTexture, Sprite, SpriteMaterial, Vector3 } from "./three.js";

function spriteOf(canvas: HTMLCanvasElement, renderOrder: number): Sprite {
  const map = new CanvasTexture(canvas);
  const sprite = new Sprite(new SpriteMaterial({ map, sizeAttenuation: false, depthTest: false, depthWrite: false }));
  sprite.renderOrder = renderOrder;
  return sprite;
}

/** The height of a label in CSS pixels, with some space around its text. */
const LABEL_PX = 28;

/** A length in centimetres, or metres from one metre on; or, with a `unit`, as a multiple of it. `largestM` is the largest beside it. */
export const lengthText = (m: number, unit: Unit, largestM: number): string =>
  unit === null && m >= 1 ? depth(m, unit) : size(m, unit, largestM);

/** A text, with a border in the colour of what it is about. */
export function labelOf(text: string, colour: string): Sprite {
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
    context.strokeStyle = colour;
    context.lineWidth = 4;
    context.stroke();
    context.fillStyle = "#ffffff";
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillText(text, 128, 33);
  }
  const sprite = spriteOf(canvas, 3);
  sprite.userData.share = share;
  return sprite;
}

/**
 * Keeps labels apart and in sight, each at its line, as seen from the camera, in one size on the screen; the first ones first.
 * @param viewPx the height of the view in CSS pixels
 */
export function spreadLabels(labels: readonly Sprite[], camera: PerspectiveCamera, viewPx: number): void {
  const [across = 1, , , , , down = 1] = camera.projectionMatrix.elements;
  // In the units of the view, which is 2 high and 2 wide.
  const height = (2 * LABEL_PX) / Math.max(viewPx, 1);
  const placed: { x: number; y: number; width: number }[] = [];
  for (const label of labels) {
    label.scale.set((4 * height) / down, height / down, 1);
    const canvasWidth = label.scale.x * across;
    const width = canvasWidth * (label.userData.share as number);
    const overlaps = ({ x, y }: Vector3) =>
      placed.some((other) => Math.abs(other.x - x) < (other.width + width) / 2 && Math.abs(other.y - y) < height);
    const [edge, end] = [Math.max(1 - width / 2, 0), 1 - height / 2];
    const isInside = ({ x, y }: Vector3) => Math.abs(x) < edge && Math.abs(y) < end;
    const places = (label.userData.places as readonly Vector3[]).map((place) => ({
      place,
      at: label.parent?.localToWorld(place.clone()).project(camera) ?? new Vector3(),
    }));
    const free = places.filter(({ at }) => !overlaps(at));
    const found = free.find(({ at }) => isInside(at)) ?? free[0];
    // Rather none than one upon another.
    label.visible = found !== undefined;
    if (found === undefined) continue;
    label.position.copy(found.place);
    placed.push({ x: found.at.x, y: found.at.y, width });
  }
}

/** The height of the mark as a share of the view, for a field of view of 90°. */
const MARK_SIZE = 0.045;

/** A ring that marks a point: a white circle with dark edges, visible on every background. */
export function markOf(): Sprite {
  const size = 64;
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [size, size];
  const context = canvas.getContext("2d");
  for (const [colour, width] of [
    ["#10141a", 0.26],
    ["#ffffff", 0.12],
  ] as const) {
    if (context === null) break;
    context.strokeStyle = colour;
    context.lineWidth = width * size;
    context.beginPath();
    context.arc(size / 2, size / 2, 0.35 * size, 0, 2 * Math.PI);
    context.stroke();
  }
  const mark = spriteOf(canvas, 1);
  mark.scale.setScalar(MARK_SIZE);
  mark.visible = false;
  return mark;
}
