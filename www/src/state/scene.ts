/** The scene: a depth map with its camera, an optional photo, and the objects in it. */
import { computed, signal } from "@preact/signals";
import type { PinholeCamera, Support } from "sim3align";
import type { ObjectModel } from "./object-model.js";

export interface Scene {
  readonly name: string;
  /** The id of the sample, or null for the user's own files. */
  readonly sample: string | null;
  /** Row-major; 0 is no reading. */
  readonly depthM: Float32Array;
  readonly width: number;
  readonly height: number;
  readonly camera: Pick<PinholeCamera, "fx" | "fy" | "cx" | "cy">;
  /** The photo, resized to the depth map. */
  readonly rgba: Uint8ClampedArray | null;
  readonly objects: readonly ObjectModel[];
  /** Warnings of the file readers. */
  readonly warnings: readonly string[];
}

/** The state of a scene: what is shown, and which object is selected. */
export function sceneState() {
  const scene = signal<Scene | null>(null);

  /** The plane on which the objects of the scene stand, once it is known. */
  const support = signal<Support | null>(null);

  const selectedId = signal<string | null>(null);

  /** The object that panels and handles apply to. */
  const selected = computed<ObjectModel | null>(() => {
    const objects = scene.value?.objects ?? [];
    return objects.find(({ id }) => id === selectedId.value) ?? objects[0] ?? null;
  });

  function select(id: string | null): void {
    if (id !== null) selectedId.value = id;
  }

  /** The object whose mask contains the pixel. */
  function objectAt(x: number, y: number): ObjectModel | null {
    const current = scene.value;
    if (current === null) return null;
    return current.objects.find(({ mask, isShown }) => isShown.value && mask[y * current.width + x] !== 0) ?? null;
  }

  return { scene, support, selected, select, objectAt };
}

export type SceneState = ReturnType<typeof sceneState>;
