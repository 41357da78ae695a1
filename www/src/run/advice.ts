/** The cause of a result that is not right, told by measured tests, and what helps. An unknown cause is not guessed. */
import type { Metrics, WarningCode } from "sim3align";
import { type Evidence, evidenceOf } from "../draw/evidence.js";
import { isMetric } from "../state/calibration.js";
import type { ObjectModel } from "../state/object-model.js";
import { isResult } from "../state/pose.js";
import type { Scene } from "../state/scene.js";
import { centimetres, percent } from "../ui/format.js";

export type Cause = "moved" | "mask" | "relative" | "occluded" | "mesh" | "unit";

/** What the button does: back to the result of the alignment, or to the files. */
export type Remedy = { title: string; act: "result" | "files" };

export interface Advice {
  cause: Cause;
  text: string;
  /** Null if nothing is wrong. */
  remedy: Remedy | null;
}

/** What the tests look at. */
export interface Findings extends Evidence {
  /** Whether a person has set the pose. */
  isByHand: boolean;
  /** The overlap (IoU) of mask and mesh: at the present pose, and where the last alignment has put it. */
  iou: number;
  foundIou: number | null;
  /** That of the pose, if an alignment has found it. */
  confidence: number | null;
  warnings: readonly WarningCode[];
  isMetric: boolean;
  /** The unit that was assumed for the depth map; null if it was given. */
  assumedUnit: string | null;
}

interface Row extends Pick<Advice, "cause" | "remedy"> {
  test(of: Findings): boolean;
  text(of: Findings): string;
}

/** Overlaps below this are low. */
const LOW_IOU = 0.85;
/** Overlaps below this are no fit at all. */
const WRONG_IOU = 0.7;

const has = ({ warnings }: Findings, ...codes: readonly WarningCode[]) => codes.some((code) => warnings.includes(code));

const files = (what: string): Remedy => ({ title: `Change the ${what} …`, act: "files" });

/**
 * The causes, the surest first. The limits are set on half of the real cases, with inputs made wrong on purpose
 * (docs/design-history.md).
 */
const rows: readonly Row[] = [
  {
    cause: "moved",
    test: ({ isByHand, visibleIou, foundIou, iou }) =>
      isByHand && visibleIou < WRONG_IOU && foundIou !== null && foundIou > iou + 0.15,
    text: ({ iou, foundIou }) =>
      `Moved by hand, the object overlaps its mask by ${percent(iou)}; where the alignment had put it, by ${percent(foundIou ?? 0)}.`,
    remedy: { title: "Back to the result", act: "result" },
  },
  {
    cause: "mask",
    // A thin object that lies on the surface fits its mask and depth.
    test: ({ bulge, step, confidence }) => bulge < 0.05 && step < 0.045 && (confidence ?? 0) < 0.7,
    text: () => "The mask shows a flat surface that goes on around it, not an object.",
    remedy: files("mask"),
  },
  {
    cause: "relative",
    test: (of) =>
      of.isMetric &&
      !of.isByHand &&
      (has(of, "DEPTH_LOOKS_NORMALISED", "DEPTH_LOOKS_TOO_SMALL") ||
        (has(of, "DEPTH_LOOKS_INVERTED") && of.residual > 0.012) ||
        (of.residual > 0.07 && of.visibleIou > LOW_IOU && (of.confidence ?? 1) < 0.5)),
    text: () => "The mesh fits the mask but not the depth: the depth map looks relative or inverted, not metric.",
    remedy: files("depth map"),
  },
  {
    cause: "occluded",
    test: (of) =>
      of.isBehindSomething &&
      of.visibleIou >= LOW_IOU &&
      of.hidden > 0.1 &&
      of.residual < 0.04 &&
      !has(of, "MESH_DOUBTFUL"),
    text: ({ hidden }) => `The overlap is low because ${percent(hidden)} of the object is behind something else.`,
    remedy: null,
  },
  {
    cause: "mesh",
    test: (of) => !of.isByHand && has(of, "MESH_DOUBTFUL") && (of.confidence ?? 1) < 0.5 && of.visibleIou < 0.93,
    text: () => "The mesh does not fit what the mask shows: it is probably that of another object.",
    remedy: files("mesh"),
  },
  {
    cause: "unit",
    test: ({ assumedUnit, distanceM, extentM }) => assumedUnit !== null && distanceM > 2.5 && extentM > 0.5,
    text: ({ assumedUnit, distanceM, extentM }) =>
      `Is it really ${centimetres(extentM)} cm across and ${distanceM.toFixed(1)} m away? The unit of the depth map was assumed: ${assumedUnit}.`,
    remedy: files("unit"),
  },
];

/** The cause, or null if none is sure. */
export function adviceOn(findings: Findings): Advice | null {
  const row = rows.find(({ test }) => test(findings));
  return row === undefined ? null : { cause: row.cause, text: row.text(findings), remedy: row.remedy };
}

/** Each pose has metrics of its own. */
const given = new WeakMap<Metrics, Advice | null>();

/** The advice on the present pose of an object, once its metrics are known. */
export function adviceFor(scene: Scene, object: ObjectModel): Advice | null {
  const metrics = object.metrics.value;
  if (metrics === null) return null;
  const known = given.get(metrics);
  if (known !== undefined) return known;
  const advice = adviceOn(findingsOf(scene, object, metrics));
  given.set(metrics, advice);
  return advice;
}

function findingsOf(scene: Scene, object: ObjectModel, metrics: Metrics): Findings {
  const { alignment, confidence, pose } = object;
  const assumed = /^(.*?) \(.*assumed\)$/.exec(scene.depthUnit)?.[1];
  return {
    ...evidenceOf(scene, object),
    isByHand: !isResult(pose.value.source),
    iou: metrics.iou ?? 0,
    foundIou: alignment.value?.metrics.iou ?? null,
    confidence,
    warnings: alignment.value?.warnings.map(({ code }) => code) ?? [],
    isMetric: isMetric(scene),
    assumedUnit: scene.raw === null ? (assumed ?? null) : null,
  };
}
