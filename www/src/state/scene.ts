/** The scene: a depth map with its camera, an optional photo, and the objects in it. */
import { batch, computed, signal } from "@preact/signals";
import type { DepthCalibration, Support } from "sim3align";
import type { DepthImage } from "sim3align/formats";
import type { ObjectModel } from "./object-model.js";
import { type Intrinsics, isMetric, type RawView } from "./raw-view.js";
import { visibleExtent } from "./visible-extent.js";

export interface Scene {
  readonly name: string;
  /** The id of the sample, or null for the user's own files. */
  readonly sample: string | null;
  /** Row-major; 0 is no reading. */
  readonly depthM: Float32Array;
  readonly width: number;
  readonly height: number;
  readonly camera: Intrinsics;
  /** The photo, resized to the depth map. */
  readonly rgba: Uint8ClampedArray | null;
  readonly objects: readonly ObjectModel[];
  /** What is given of a view whose depth or focal length are not fully known; otherwise null. */
  readonly raw: RawView | null;
  /** What such a view was taken to be in the last alignment of the whole scene, in whose depth the poses are. */
  readonly calibration: DepthCalibration | null;
  /** The unit of the depth map. */
  readonly depthUnit: DepthImage["unit"];
  /** Where the camera comes from, if none was given. */
  readonly cameraSource: string | null;
  /** Warnings of the file readers and of the calibration. */
  readonly warnings: readonly string[];
}

/** How lengths of a scene are shown: null in metres, otherwise as multiples of this one, the longest side of the first object. */
export function unitOf(scene: Scene): number | null {
  const [first] = scene.objects;
  return first === undefined || isMetric(scene) ? null : Math.max(...first.box.value.sizeM) || 1;
}

/** The state of a scene: what is shown, and which object is selected. */
export function sceneState() {
  const scene = signal<Scene | null>(null);

  /** The plane on which the objects of the scene stand, once it is known. */
  const support = signal<Support | null>(null);

  const chosen = signal<ObjectModel | null>(null);

  /** Only another scene has other ones: the same list means the same scene, perhaps in another calibration. */
  const objects = computed<readonly ObjectModel[]>(() => scene.value?.objects ?? []);

  /** The object that panels and handles apply to: in another scene, the first one. */
  const selected = computed<ObjectModel | null>(
    () => objects.value.find((object) => object === chosen.value) ?? objects.value[0] ?? null,
  );

  /** The object whose name is being changed. */
  const renamed = signal<ObjectModel | null>(null);

  /** How lengths are shown. */
  const unit = computed<number | null>(() => scene.value && unitOf(scene.value));

  /** Shows the scene in the depth of another calibration. */
  function recalibrate(whole: Scene): void {
    const { depthM: data, width, camera } = whole;
    batch(() => {
      scene.value = whole;
      for (const object of whole.objects) {
        object.visible.value = visibleExtent({ data, width }, object.mask, camera);
        if (!object.isPlaced) object.pose.value = object.start.value;
      }
    });
  }

  function select(id: string | null): void {
    chosen.value = objects.peek().find((object) => object.id === id) ?? chosen.peek();
  }

  /** The object whose mask contains the pixel. */
  function objectAt(x: number, y: number): ObjectModel | null {
    const current = scene.value;
    if (current === null) return null;
    return current.objects.find(({ mask, isShown }) => isShown.value && mask[y * current.width + x] !== 0) ?? null;
  }

  return { scene, objects, support, selected, renamed, unit, recalibrate, select, objectAt };
}

export type SceneState = ReturnType<typeof sceneState>;
