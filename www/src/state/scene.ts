/** What is looked at: a depth map with its camera, a photo where there is one, and the objects in it. */
import { computed, signal } from "@preact/signals";
import type { PinholeCamera } from "sim3align";
import type { ObjectModel } from "./object-model.js";

/** The observation. */
export interface Scene {
  readonly name: string;
  /** The sample that it is, or null for a user's own files. */
  readonly sample: string | null;
  /** Row by row; 0 is no reading. */
  readonly depthM: Float32Array;
  readonly width: number;
  readonly height: number;
  readonly camera: Pick<PinholeCamera, "fx" | "fy" | "cx" | "cy">;
  /** The photo at the depth map's size. */
  readonly rgba: Uint8ClampedArray | null;
  readonly objects: readonly ObjectModel[];
  /** What the files' readers warned of. */
  readonly warnings: readonly string[];
}

export const scene = signal<Scene | null>(null);

const selectedId = signal<string | null>(null);

/** The object that panels and gizmo are about. */
export const selected = computed<ObjectModel | null>(() => {
  const objects = scene.value?.objects ?? [];
  return objects.find(({ id }) => id === selectedId.value) ?? objects[0] ?? null;
});

export function select(id: string | null): void {
  if (id !== null) selectedId.value = id;
}

/** The object whose mask has the pixel. */
export function objectAt(x: number, y: number): ObjectModel | null {
  const found = scene.value;
  if (found === null) return null;
  return found.objects.find(({ mask }) => mask[y * found.width + x] !== 0) ?? null;
}
