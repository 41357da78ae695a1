/** Results of scenes as plain data. */
import type { Metrics, Sim3 } from "sim3align";
import type { Inputs, MaskSource } from "../load/inputs.js";
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

/** Who has decided on the pose: a person who has accepted or set it, or the search. */
function decidedBy({ isAccepted, pose }: ObjectModel): "accepted" | "hand" | "search" | null {
  const { source } = pose.value;
  if (source === "start") return null;
  return isAccepted.value ? "accepted" : source === "hand" || source === "alternative" ? "hand" : "search";
}

const nameOf = ({ file, label, annotation }: MaskSource) => ({
  ...{ mask: file.path },
  ...(label !== undefined && { label }),
  ...(annotation !== undefined && { annotation }),
});

/** The names of an object's files as given. */
const filesOf = (given: Inputs["objects"][number] | undefined) => ({
  ...(given?.mask && nameOf(given.mask)),
  ...(given?.mesh && { mesh: given.mesh.file.path }),
});

function jsonEntry(object: ObjectModel, unit: number | null, given: Inputs["objects"][number] | undefined) {
  const { pose, box, confidence, isAccepted, precise, metrics } = object;
  const { transform, source } = pose.value;
  const sides = [...box.value.sizeM];
  return {
    ...plain(transform),
    source,
    accepted: isAccepted.value,
    decidedBy: decidedBy(object),
    files: filesOf(given),
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
export function sceneResult(scene: Scene, inputs: Inputs): SceneResult {
  const unit = unitOf(scene);
  const entries = scene.objects.map((object, i) => [keyOf(scene, object), jsonEntry(object, unit, inputs.objects[i])]);
  return { ...Object.fromEntries(entries), _about: about(scene, inputs) };
}

function about(scene: Scene, { depth, depthScale, name }: Inputs) {
  const { camera, calibration, cameraSource, depthUnit, height, width } = scene;
  const units = isMetric(scene) ? "metres" : "unknown";
  return {
    convention: `x_cam = scale · rotation · p_mesh + translation; OpenCV camera (x right, y down, z forward), ${units === "metres" ? units : "unit unknown"}`,
    units,
    scene: name,
    depthFile: depth?.path ?? null,
    camera: { ...camera, width, height },
    ...(cameraSource === null ? {} : { cameraSource }),
    depthUnit,
    isUnitGiven: depthScale !== null,
    ...(calibration === null ? {} : { depthCalibration: calibration }),
    options: options.value,
  };
}
