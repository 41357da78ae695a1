/** Draws a photo with the mask that is being made. */
import { rgbOf } from "../pictures/colours.js";
import type { Mark } from "./strokes.js";

interface Shown {
  marks: readonly Mark[];
  /** The stroke that is being drawn. */
  drawn: Mark | null;
  cross: readonly [number, number];
  colour: string;
}

/** How much of the colour covers the object, and how much of the rest is left. */
const [COVER, REST] = [0.45, 0.55];

/** Draws on a canvas of the size of the view. */
export function drawMarks(
  canvas: HTMLCanvasElement,
  { rgba, width, height }: { rgba: Uint8ClampedArray; width: number; height: number },
  mask: Uint8Array,
  { marks, drawn, cross: [x, y], colour }: Shown,
): void {
  const context = canvas.getContext("2d");
  if (context === null) return;
  const image = new ImageData(width, height);
  const own = rgbOf(colour);
  const isEmpty = !mask.includes(1);
  for (let i = 0; i < mask.length; i++) {
    for (let k = 0; k < 3; k++) {
      const seen = rgba[4 * i + k] as number;
      const shown = mask[i] === 1 ? (1 - COVER) * seen + COVER * (own[k] as number) : isEmpty ? seen : REST * seen;
      image.data[4 * i + k] = shown;
    }
    image.data[4 * i + 3] = 255;
  }
  context.putImageData(image, 0, 0);
  const unit = Math.max(width, height) / 400;
  for (const mark of drawn === null ? marks : [...marks, drawn]) {
    const isLine = mark === drawn || mark.points.length > 1;
    context.strokeStyle = mark.adds ? "#3ddc84" : "#ff5c5c";
    context.lineCap = context.lineJoin = "round";
    context.lineWidth = mark === drawn ? 2 * mark.radius : 1.5 * unit;
    context.globalAlpha = mark === drawn ? 0.6 : 1;
    context.beginPath();
    const [from] = mark.points;
    if (from === undefined) continue;
    if (isLine) for (const [u, v] of [from, ...mark.points]) context.lineTo(u + 0.5, v + 0.5);
    else context.arc(from[0] + 0.5, from[1] + 0.5, 2 * unit, 0, 2 * Math.PI);
    context.stroke();
  }
  context.globalAlpha = 1;
  for (const [style, thickness] of [
    ["#000", 3],
    ["#fff", 1],
  ] as const) {
    context.strokeStyle = style;
    context.lineWidth = thickness * unit * 0.7;
    context.beginPath();
    for (const [dx, dy] of [
      [1, 0],
      [0, 1],
    ] as const) {
      context.moveTo(x + 0.5 - 6 * unit * dx, y + 0.5 - 6 * unit * dy);
      context.lineTo(x + 0.5 + 6 * unit * dx, y + 0.5 + 6 * unit * dy);
    }
    context.stroke();
  }
}
