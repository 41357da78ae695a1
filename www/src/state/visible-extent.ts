/** The rough position and size of the visible part of an object, for its start pose. */
import type { DepthImage } from "sim3align/formats";
import type { VisibleExtent } from "./object-model.js";
import type { Intrinsics } from "./raw-view.js";

/** Upper bound on the readings that are used. */
const MAX_READINGS = 4000;
/** Of larger images, only every third pixel or fewer is looked at. */
const MOST_PIXELS = 2_100_000;

/** The centre of the readings in a mask and the diagonal of their bounding box without outliers; metres. */
export function visibleExtent(
  { data, width }: Pick<DepthImage, "data" | "width">,
  mask: Uint8Array,
  { fx, fy, cx, cy }: Intrinsics,
): VisibleExtent {
  const isReading = (pixel: number) => mask[pixel] !== 0 && (data[pixel] as number) > 0;
  // An odd step looks at all columns.
  const step = 2 * Math.floor(mask.length / MOST_PIXELS) + 1;
  let count = 0;
  for (let pixel = 0; pixel < mask.length; pixel += step) if (isReading(pixel)) count++;
  const stride = Math.max(1, Math.ceil(count / MAX_READINGS));
  const [xs, ys, zs]: [number[], number[], number[]] = [[], [], []];
  let i = 0;
  for (let pixel = 0; pixel < mask.length; pixel += step) {
    if (!isReading(pixel) || i++ % stride !== 0) continue;
    const z = data[pixel] ?? 0;
    xs.push((((pixel % width) - cx) * z) / fx);
    ys.push(((Math.floor(pixel / width) - cy) * z) / fy);
    zs.push(z);
  }
  if (zs.length === 0) return { centreM: [0, 0, 1], sizeM: 0.1 };
  const ranges = [xs, ys, zs].map((values) => {
    const sorted = values.sort((a, b) => a - b);
    // Masks often contain a few background readings, which would stretch the box.
    const quantile = (share: number) => sorted[Math.round(share * (sorted.length - 1))] ?? 0;
    return { low: quantile(0.02), high: quantile(0.98) };
  });
  return {
    centreM: ranges.map(({ low, high }) => (low + high) / 2) as [number, number, number],
    sizeM: Math.hypot(...ranges.map(({ low, high }) => high - low)) || 0.1,
  };
}
