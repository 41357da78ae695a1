/** Makes a length of an object known. */
import { compose, toSim3 } from "sim3align/conventions/similarity";
import type { Vector3 } from "sim3align/values/validation";
import { inCalibration } from "../state/calibration.js";
import type { AnyAlignment, ObjectModel, PreciseAlignment } from "../state/object-model.js";
import type { Pose } from "../state/pose.js";
import { isMetric } from "../state/scene.js";
import type { Workspace } from "../state/workspace.js";
import { poseOf, progressOf, run } from "./align.js";
import { aligner, inputOf } from "./aligner.js";

/** What an object would be with a known size. It counts only if a person takes it. */
export interface Trial {
  /** The pose that it is compared with. */
  readonly from: Pose;
  readonly pose: Pose;
  readonly sizeM: Vector3;
  /** The overlap (IoU) of mask and mesh. */
  readonly iou: number | null;
  readonly confidence: number | null;
}

/** Whether a known length of the object can be compared with a result: the unit is known, and there is one. */
export const canTry = ({ scene }: Workspace, object: ObjectModel): boolean =>
  object.isPlaced && scene.value !== null && isMetric(scene.value);

/** Aligns an object at its size times a factor. Null if no pose was found, or another alignment is running. */
export async function trySize(workspace: Workspace, object: ObjectModel, factor: number): Promise<Trial | null> {
  const { alignOptions, byHand } = workspace;
  const from = object.pose.peek();
  const { transform: initial } = byHand(object, { scale: factor });
  let trial: Trial | null = null;
  await run(workspace, [object], async (whole, signal) => {
    const options = { ...alignOptions(object, "global"), scale: initial.scale, initial, signal };
    const found = await (await aligner()).align(inputOf(whole, object), { ...options, onProgress: progressOf(object) });
    object.run.value = { state: "done" };
    const sizeM = object.box.peek().sizeM.map((side) => side * factor) as Vector3;
    const { confidence, metrics } = found;
    trial = { from, pose: poseOf(found, "aligned"), sizeM, iou: metrics.iou, confidence };
  });
  if (trial !== null) workspace.announce("Compare the change, then use it or keep the old.");
  return trial;
}

/** Makes a trial the pose of the object. Every alignment keeps its scale. */
export function takeTrial({ record }: Workspace, object: ObjectModel, { pose }: Trial): void {
  record(object, () => {
    object.pose.value = pose;
    object.lockScale(true);
  });
}

/**
 * Scales an object by a factor, after which it has its known size. If the unit of the depth map is unknown, the whole scene is
 * scaled: it is metric from then on.
 */
export function setKnownSize(workspace: Workspace, object: ObjectModel, factor: number): void {
  const { byHand, recalibrate, record, scene, support } = workspace;
  const whole = scene.peek();
  record(object, () => {
    if (whole === null || isMetric(whole) || whole.calibration === null) {
      object.pose.value = byHand(object, { scale: factor });
    } else {
      const { calibration } = whole;
      recalibrate(
        inCalibration(whole, { ...calibration, isMetric: true, scale: calibration.scale * factor }, whole.warnings),
      );
      for (const one of whole.objects) if (one.isPlaced) one.rebase(poseInUnit(one.pose.peek(), factor));
      const plane = support.peek();
      if (plane !== null) support.value = { ...plane, d: plane.d * factor };
    }
    object.lockScale(true);
  });
}

const unitOf = (factor: number) => ({ scale: factor, rotation: [0, 0, 0, 1], translation: [0, 0, 0] });

/** The pose in a unit of which the present one has `factor`. */
function poseInUnit(pose: Pose, factor: number): Pose {
  const alignment = pose.alignment ? inUnit(pose.alignment, factor) : null;
  // To the last bit that of the alignment, so that it still counts as found by it.
  const isFound = alignment !== null && (pose.source === "aligned" || pose.source === "refined");
  return { ...pose, transform: isFound ? toSim3(alignment) : compose(unitOf(factor), pose.transform), alignment };
}

/** The result in a unit of which the present one has `factor`. */
function inUnit(alignment: AnyAlignment, factor: number): AnyAlignment {
  const scaled = <T extends AnyAlignment | PreciseAlignment["alternatives"][number]>(of: T): T => ({
    ...of,
    ...compose(unitOf(factor), of),
  });
  const { contact, metrics, ...of } = alignment;
  const { depthMaeM, uniChamferM, chamferM } = metrics;
  const length = (value: number | null) => value && value * factor;
  return {
    ...scaled(of as AnyAlignment),
    metrics: {
      ...metrics,
      ...{ depthMaeM: length(depthMaeM), uniChamferM: length(uniChamferM), chamferM: length(chamferM) },
    },
    ...("alternatives" in of ? { alternatives: of.alternatives.map(scaled) } : {}),
    ...("uncertainty" in of && of.uncertainty
      ? { uncertainty: { ...of.uncertainty, distanceM: of.uncertainty.distanceM * factor } }
      : {}),
    ...(contact === undefined ? {} : { contact: { ...contact, gapM: length(contact.gapM) } }),
  } as AnyAlignment;
}
