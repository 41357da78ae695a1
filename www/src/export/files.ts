/** Writers of results, in formats that other programs read. */
import type { Metrics } from "sim3align";
import { exportGlb, exportPly, exportSceneGlb, placeGlb, type Sim3, toBop, toRowMajor } from "sim3align/conventions";
import { isMetric } from "../state/calibration.js";
import type { ObjectModel } from "../state/object-model.js";
import { page } from "../state/page.js";
import { isResult } from "../state/pose.js";
import type { Scene } from "../state/scene.js";

const { framePoses, options, support, unit, video } = page;

/** The 16 numbers of a pose as a JSON array of four lines. */
export function matrixText({ pose }: ObjectModel, order: "column" | "row"): string {
  const { transform } = pose.value;
  const numbers = order === "column" ? transform.matrix : toRowMajor(transform);
  return `[${Array.from({ length: 4 }, (_, i) => numbers.slice(4 * i, 4 * i + 4).join(", ")).join(",\n ")}]`;
}

const plain = ({ matrix, scale, rotationMatrix, rotation, translation }: Sim3) => ({
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

function jsonEntry({ pose, box, isAccepted, precise, metrics }: ObjectModel, unit: number | null) {
  const { transform, source } = pose.value;
  const sides = [...box.value.sizeM];
  return {
    ...plain(transform),
    source,
    accepted: isAccepted.value,
    // As multiples of the longest side of the first object where the unit is unknown.
    ...(unit === null ? { sizeM: sides } : { relativeSize: sides.map((side) => side / unit) }),
    // The confidence is that of the aligned pose, not of one that was changed by hand.
    confidence: isResult(source) ? (precise?.confidence ?? null) : null,
    metrics: unit === null ? metrics.value : withoutLengths(metrics.value),
    alternatives: precise?.alternatives.map(plain) ?? [],
  };
}

/** The metrics that are no lengths. */
const withoutLengths = (metrics: Metrics | null) =>
  metrics && Object.fromEntries(Object.entries(metrics).filter(([name]) => !name.endsWith("Mm")));

/** The poses of a video, by the names of its frames; as `sim3align track --json` writes them. */
export function videoText(name: string): string {
  const frames = (video.value?.frames ?? []).map((frame, i) => {
    const pose = framePoses.value[i];
    return [
      frame.name,
      pose == null ? null : { ...plain(pose.transform), confidence: pose.confidence, state: pose.state },
    ];
  });
  return JSON.stringify({ [name]: { frames: Object.fromEntries(frames) } }, null, 2);
}

/** The poses of all objects by name. The command line reads it with `--transform` and `--initial`. */
export function jsonText(scene: Scene): string {
  const entries = scene.objects.map((object) => [keyOf(scene, object), jsonEntry(object, unit.value)]);
  return JSON.stringify({ ...Object.fromEntries(entries), _about: about(scene) }, null, 2);
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

/** BOP's `scene_gt.json`. BOP models are in millimetres, so each entry holds the factor for the mesh. */
export function bopText({ objects }: Scene): string {
  const entries = objects.map(({ pose, name }, i) => {
    const { entry, scale } = toBop(pose.value.transform, { objId: i + 1 });
    return { ...entry, name, model_mm_per_mesh_unit: 1000 * scale };
  });
  return JSON.stringify({ 0: entries }, null, 2);
}

/** The mesh at its pose and metric scale. A GLB keeps its materials. */
export function glbBytes({ pose, mesh, glb }: ObjectModel): Uint8Array {
  const { transform } = pose.value;
  return glb === null ? exportGlb(mesh, transform) : placeGlb(glb, transform);
}

/** All placed objects in one GLB, in metres, y up; on the ground at y = 0 if the support is known. */
export function sceneBytes({ objects }: Scene): Uint8Array {
  const placed = objects.filter(({ isPlaced }) => isPlaced);
  const nodes = placed.map(({ name, mesh, glb, pose }) => ({
    name,
    mesh: glb ?? mesh,
    transform: pose.value.transform,
  }));
  return exportSceneGlb(nodes, { support: support.value });
}

/** The mesh at its pose and metric scale as PLY, in the OpenCV camera frame. */
export const plyBytes = ({ pose, mesh }: ObjectModel): Uint8Array => exportPly(mesh, pose.value.transform);
