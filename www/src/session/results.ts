/** Results of scenes as plain data. */

import type { Metrics, Sim3 } from "sim3align";
import { toSim3 } from "sim3align/conventions/similarity";
import type { Inputs } from "../state/inputs.js";
import type { ObjectModel, Verdict } from "../state/object-model.js";
import type { ObjectWork } from "../state/object-work.js";
import { page } from "../state/page.js";
import type { PoseSource } from "../state/pose.js";
import { isMetric, type Scene, unitOf } from "../state/scene.js";
import type { FramePose, VideoWork } from "../state/video.js";

const { options } = page;

/** The transform of a pose. */
const transformOf = ({ scale, rotation, rotationMatrix, translation, matrix }: Sim3): Sim3 => ({
  ...{ scale, rotation, rotationMatrix, translation, matrix },
});

/** A unique key for an object: its name, with a number if several objects have the same name. */
export function keyOf(scene: Scene, object: ObjectModel): string {
  const namesakes = scene.objects.filter(({ name }) => name === object.name);
  return namesakes.length === 1 ? object.name : `${object.name} ${Number(object.id) + 1}`;
}

/** What a person has decided: an accepted pose that is not as the search has found it is a corrected one. */
export const decisionOf = (verdict: Verdict | null, source: PoseSource): Verdict | "corrected" | null =>
  verdict === "accepted" && source !== "aligned" && source !== "tracked" ? "corrected" : verdict;

/** The names of an object's files as given. */
const filesOf = (given: Inputs["objects"][number] | undefined) => ({
  ...(given?.mask && { mask: given.mask.file.path }),
  ...(given?.mesh && { mesh: given.mesh.file.path }),
});

function jsonEntry(object: ObjectModel, unit: number | null, given: Inputs["objects"][number] | undefined) {
  const { pose, box, comment, confidence, verdict, precise, metrics } = object;
  const { transform, source } = pose.value;
  const sides = [...box.value.sizeM];
  return {
    ...transformOf(transform),
    source,
    decision: decisionOf(verdict.value, source),
    comment: comment.value,
    files: filesOf(given),
    // As multiples of the longest side of the first object where the unit is unknown.
    ...(unit === null ? { sizeM: sides } : { relativeSize: sides.map((side) => side / unit) }),
    confidence,
    metrics: unit === null ? metrics.value : withoutLengths(metrics.value),
    alternatives: precise?.alternatives.map(transformOf) ?? [],
  };
}

/** The metrics that are no lengths. */
const withoutLengths = (metrics: Metrics | null) =>
  metrics && Object.fromEntries(Object.entries(metrics).filter(([name]) => !name.endsWith("M")));

/** What `sceneResult` returns. */
export type SceneResult = Record<string, object>;

/** The poses of all objects by name, and what they refer to. The command line reads it with `--transform` and `--initial`. */
export function sceneResult(scene: Scene, inputs: Inputs): SceneResult {
  const unit = unitOf(scene);
  const entries = scene.objects.map((object, i) => [keyOf(scene, object), jsonEntry(object, unit, inputs.objects[i])]);
  return { ...Object.fromEntries(entries), _about: about(scene, inputs) };
}

/** The pose in a frame of a video. One that was set but not accepted is no result yet. */
export const poseIn = (pose: FramePose | null = null, work: ObjectWork | null = null): Sim3 | null =>
  work?.verdict === "accepted" ? toSim3(work.matrix) : (pose?.transform ?? null);

/** The poses of a video by the names of its frames, as `sim3align track --json` writes them, with what was decided. */
export function videoResult(frames: readonly Inputs[], { framePoses, frameWorks }: VideoWork): SceneResult {
  const entries = frames.map(({ name }, i) => {
    const [pose, work] = [framePoses[i] ?? null, frameWorks[i] ?? null];
    const { source = "tracked", comment = "", verdict = null } = work ?? {};
    const held = poseIn(pose, work);
    if (held === null) return [name, null];
    const { confidence = null, state = "lost" } = pose ?? {};
    return [name, { ...transformOf(held), confidence, state, decision: decisionOf(verdict, source), comment }];
  });
  return { frames: Object.fromEntries(entries) };
}

function about(scene: Scene, { depth, name }: Inputs) {
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
    ...(calibration === null ? {} : { depthCalibration: calibration }),
    options: options.value,
  };
}
