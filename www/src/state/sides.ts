/** The sides of an object in the order in which people name them. */
import type { Support } from "sim3align";
import { applyToPoints } from "sim3align/conventions/similarity";
import type { ObjectModel } from "./object-model.js";
import { tightBoundsOf } from "./pose.js";

/** How far a side leans from the vertical that is still a height. */
const LEANS_DEG = 20;

export interface Sides {
  /** The indices of the sides, as they are named. */
  order: readonly number[];
  /** Whether they are width, depth and height; otherwise, the longest comes first. */
  isUpright: boolean;
}

/** Lengths of an object's sides in that order. */
export const inOrder = ({ order }: Sides, sizeM: readonly number[]): number[] => order.map((k) => sizeM[k] ?? 0);

/** Width, depth and height where the ground is known and the object stands on one of its sides. */
export function sidesOf({ box, mesh, pose }: ObjectModel, ground: Support | null): Sides {
  const { sizeM } = box.value;
  const longestFirst = [0, 1, 2].sort((a, b) => (sizeM[b] as number) - (sizeM[a] as number));
  if (ground === null) return { order: longestFirst, isUpright: false };
  const corners = applyToPoints(pose.value.transform, Float64Array.from(tightBoundsOf(mesh).corners.flat()));
  const uprightness = [1, 2, 4].map((bit) => {
    const side = [0, 1, 2].map((k) => (corners[3 * bit + k] as number) - (corners[k] as number));
    const along = side.reduce((sum, x, k) => sum + x * (ground.normal[k] as number), 0);
    return Math.abs(along) / (Math.hypot(...side) * Math.hypot(...ground.normal) || 1);
  });
  const height = uprightness.findIndex((one) => one > Math.cos((LEANS_DEG * Math.PI) / 180));
  if (height < 0) return { order: longestFirst, isUpright: false };
  return { order: [...longestFirst.filter((k) => k !== height), height], isUpright: true };
}
