/** Results of scenes as plain data. */
import type { Metrics } from "sim3align";
import type { Sim3 } from "sim3align/conventions";
import { isMetric } from "../state/calibration.js";
import type { ObjectModel } from "../state/object-model.js";
import { page } from "../state/page.js";
import { type Scene, unitOf } from "../state/scene.js";

const { options } = page;

export const plain = ({ matrix, scale, rotationMatrix, rotation, translation }: Sim3) => ({
  scale,
  rotation: rotationMatrix,
  quaternion: rotation,
  translation,
  matrix,
});

/** A unique key for an object: its name, with a number if several objects have the same name. */
export function keyOf(scene: Scene, object: ObjectModel): string {
  const namesakes = scene.objects.filter(({ name }) => name === object.name);
  return namesakes.length === 1 ? object.name : `${object.name} ${Number(object.id) + 1}`;
}

function jsonEntry(object: ObjectModel, unit: number | null) {
  const { pose, box, confidence, isAccepted, precise, metrics } = object;
  const { transform, source } = pose.value;
  const sides = [...box.value.sizeM];
  return {
    ...plain(transform),
    source,
    accepted: isAccepted.value,
    // As multiples of the longest side of the first object where the unit is unknown.
    ...(unit === null ? { sizeM: sides } : { relativeSize: sides.map((side) => side / unit) }),
    confidence,
    metrics: unit === null ? metrics.value : withoutLengths(metrics.value),
    alternatives: precise?.alternatives.map(plain) ?? [],
  };
}

/** The metrics that are no lengths. */
const withoutLengths = (metrics: Metrics | null) =>
  metrics && Object.fromEntries(Object.entries(metrics).filter(([name]) => !name.endsWith("Mm")));

/** What `sceneResult` returns. */
export type SceneResult = Record<string, object>;

/** The poses of all objects by name, and what they refer to. The command line reads it with `--transform` and `--initial`. */
export function sceneResult(scene: Scene): SceneResult {
  const unit = unitOf(scene);
  const entries = scene.objects.map((object) => [keyOf(scene, object), jsonEntry(object, unit)]);
  return { ...Object.fromEntries(entries), _about: about(scene) };
}
function about(scene: Scene) {
  const { camera, calibration, cameraSource, depthUnit, height, width } = scene;
  const units = isMetric(scene) ? "metres" : "unknown";
  return {
    convention: `x_cam = scale · rotation · p_mesh + translation; OpenCV camera (x right, y down, z forward), ${units === "metres" ? units : "unit unknown"}`,
    units,
    camera: { ...camera, width, height },
    ...(cameraSource === null ? {} : { cameraSource }),
    depthUnit,
    ...(calibration === null ? {} : { depthCalibration: calibration }),
    options: options.value,
  };
}
