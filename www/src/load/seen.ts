/** What is seen of an object, roughly: enough to put a mesh before it. */
import type { DepthImage } from "sim3align/formats";
import type { ObjectParts } from "../state/object-model.js";
import type { Scene } from "../state/scene.js";

/** Readings that are looked at, at most. */
const MAX_READINGS = 4000;

/** The middle of the readings inside a mask, and the diagonal of the box around most of them; metres. */
export function seenThrough(
  { data, width }: Pick<DepthImage, "data" | "width">,
  mask: Uint8Array,
  { fx, fy, cx, cy }: Scene["camera"],
): ObjectParts["seen"] {
  const pixels: number[] = [];
  mask.forEach((inside, pixel) => {
    if (inside !== 0 && (data[pixel] ?? 0) > 0) pixels.push(pixel);
  });
  const every = Math.max(1, Math.ceil(pixels.length / MAX_READINGS));
  const [xs, ys, zs]: [number[], number[], number[]] = [[], [], []];
  for (let i = 0; i < pixels.length; i += every) {
    const pixel = pixels[i] ?? 0;
    const z = data[pixel] ?? 0;
    xs.push((((pixel % width) - cx) * z) / fx);
    ys.push(((Math.floor(pixel / width) - cy) * z) / fy);
    zs.push(z);
  }
  if (zs.length === 0) return { middleM: [0, 0, 1], sizeM: 0.1 };
  const ranges = [xs, ys, zs].map((values) => {
    const sorted = values.sort((a, b) => a - b);
    // A few readings beside the object would stretch the box.
    const at = (share: number) => sorted[Math.round(share * (sorted.length - 1))] ?? 0;
    return { low: at(0.02), high: at(0.98) };
  });
  return {
    middleM: ranges.map(({ low, high }) => (low + high) / 2) as [number, number, number],
    sizeM: Math.hypot(...ranges.map(({ low, high }) => high - low)) || 0.1,
  };
}
