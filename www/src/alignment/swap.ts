/** Two masks that are swapped: each mesh fits the mask of the other object better than its own. */
import { type Signal, signal } from "@preact/signals";
import type { Inputs } from "../state/inputs.js";
import type { ObjectModel } from "../state/object-model.js";
import { SURE } from "../state/progress.js";
import type { Scene } from "../state/scene.js";
import { aligner, inputOf } from "./aligner.js";

export interface Swap {
  /** Of the two objects. */
  indices: readonly [number, number];
  names: readonly [string, string];
  /** How sure their poses would be. */
  confidences: readonly [number, number];
}

/** The inputs with the masks of two objects exchanged. */
export const exchanged =
  ({ indices: [a, b] }: Swap) =>
  (inputs: Inputs): Inputs => {
    const maskOf = (i: number) => inputs.objects[i === a ? b : i === b ? a : i]?.mask ?? null;
    return { ...inputs, objects: inputs.objects.map((one, i) => ({ ...one, mask: maskOf(i), isSure: true })) };
  };

const swaps = new WeakMap<Scene, Signal<Swap | null>>();

/** What was found in a scene; null until then. */
export function swapIn(scene: Scene): Signal<Swap | null> {
  const known = swaps.get(scene) ?? signal<Swap | null>(null);
  swaps.set(scene, known);
  return known;
}

const searched = new WeakSet<Scene>();

/** Looks for swapped masks, once for a scene whose objects are aligned. */
export async function searchSwap(scene: Scene): Promise<void> {
  if (searched.has(scene) || !scene.objects.every(({ isPlaced }) => isPlaced)) return;
  searched.add(scene);
  swapIn(scene).value = await findSwap(scene);
}

/** Of a scene with many objects, only so many pairs are tried. */
const MOST_PAIRS = 4;

/** Looks for two objects with swapped masks among those that are in doubt. */
async function findSwap(scene: Scene): Promise<Swap | null> {
  const confidenceOf = (object: ObjectModel) => object.confidence ?? 1;
  const open = scene.objects.filter(({ verdict, pose }) => verdict.peek() === null && pose.peek().source === "aligned");
  const least = [...open].sort((a, b) => confidenceOf(a) - confidenceOf(b));
  const pairs = least.flatMap((a, i) => least.slice(i + 1).map((b) => [a, b] as const));
  for (const [a, b] of pairs.slice(0, MOST_PAIRS)) {
    if (confidenceOf(a) >= SURE) return null;
    const own = Math.max(confidenceOf(a), confidenceOf(b));
    const ofA = await confidenceWith(scene, a, b);
    if (ofA <= own) continue;
    const ofB = await confidenceWith(scene, b, a);
    if (ofB <= own) continue;
    const indices = [scene.objects.indexOf(a), scene.objects.indexOf(b)] as const;
    return { indices, names: [a.name, b.name], confidences: [ofA, ofB] };
  }
  return null;
}

/** How sure the pose of an object would be with the mask of another one. */
async function confidenceWith(scene: Scene, { mesh }: ObjectModel, { mask }: ObjectModel): Promise<number> {
  try {
    const ready = await aligner();
    return (await ready.align(inputOf(scene, { mask, mesh }), { quality: "fast", metrics: false })).confidence;
  } catch {
    return 0;
  }
}
