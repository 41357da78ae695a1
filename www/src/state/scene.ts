/** The scene: a depth map with its camera, an optional photo, and the objects in it. */
import { batch, computed, signal } from "@preact/signals";
import type { DepthCalibration, DepthKind, PinholeCamera, Support } from "sim3align";
import type { DepthImage } from "sim3align/formats";
import type { ObjectModel, VisibleExtent } from "./object-model.js";

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

/** The intrinsics of a camera. */
export type Intrinsics = Pick<PinholeCamera, "fx" | "fy" | "cx" | "cy">;

/** What is given of a view whose depth or focal length are not fully known. */
export interface RawView {
  /** The values of the depth map. */
  readonly depth: Float32Array;
  readonly width: number;
  readonly height: number;
  readonly depthKind: DepthKind;
  readonly camera: Intrinsics;
  /** Relative standard deviation of the focal length; 0 if it is known. */
  readonly focalUncertainty: number;
  /** Warnings of the file readers. */
  readonly warnings: readonly string[];
}

/** What says whether depth has a unit. */
interface Depth {
  readonly raw: RawView | null;
  readonly calibration: DepthCalibration | null;
}

/** Whether lengths of a scene are metres. */
export const isMetric = ({ raw, calibration }: Depth): boolean =>
  calibration?.isMetric ?? (raw === null || raw.depthKind === "metric");

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
