/** The cause of a result that is not right, and what helps: what the package warns of, and what the page measures. An unknown cause is not guessed. */
import type { DepthKind, Metrics, WarningCode } from "sim3align";
import { doubtOfSize } from "sim3align/camera/image-camera";
import { unitText } from "sim3align/input/depth-kinds";
import type { ImageSize } from "sim3align/values/pixels";
import { type Evidence, evidenceOf } from "../pictures/evidence.js";
import { type CameraSource, type Inputs, withInverted } from "../state/inputs.js";
import type { ObjectModel } from "../state/object-model.js";
import { isResult } from "../state/pose.js";
import { SURE } from "../state/progress.js";
import type { Scene } from "../state/scene.js";
import { isMetric } from "../state/scene.js";
import type { Workspace } from "../state/workspace.js";
import { centimetres, depth, percent, significant } from "../ui/texts.js";
import { alignSelected, applyAlternative } from "./align.js";

export type Cause =
  | "moved"
  | "mask"
  | "camera"
  | "size"
  | "mirrored"
  | "depth"
  | "texture"
  | "occluded"
  | "mesh"
  | "unit";

/** The action of a button. Actions that change files need a page with files. */
export interface Remedy {
  title: string;
  needsFiles: boolean;
  act(workspace: Workspace, object: ObjectModel): unknown;
}

export interface Advice {
  cause: Cause;
  text: string;
  remedies: readonly Remedy[];
  /** The warnings that it stands for. */
  codes: readonly WarningCode[];
}

/** The evidence for the tests. */
interface Findings extends Evidence {
  /** The index of the object. */
  index: number;
  /** Whether the pose was set by hand. */
  isByHand: boolean;
  /** Whether the size was entered. */
  isSizeKnown: boolean;
  /** The overlap (IoU) of mask and mesh: at the present pose, and where the last alignment has put it. */
  iou: number;
  foundIou: number | null;
  /** That of the pose; 1 for one that no alignment has found. */
  confidence: number;
  warnings: readonly WarningCode[];
  depthKind: DepthKind;
  isMetric: boolean;
  depthUnit: Scene["depthUnit"];
  camera: Scene["camera"];
  /** The length of the ray to the farthest corner of the image, over its depth. */
  wideness: number;
  /** By how much the image to which the intrinsics seem to belong is smaller; null if they seem to be those of this one. */
  cameraFactor: number | null;
}

interface Row {
  cause: Cause;
  codes?: readonly WarningCode[];
  test(of: Findings): boolean;
  text(of: Findings): string;
  remedies?(of: Findings): readonly Remedy[];
}

/** Overlaps below this are low. */
const LOW_IOU = 0.85;
/** Overlaps below this are no fit at all. */
const WRONG_IOU = 0.7;
/** From this ratio of ray and depth on, distances along rays bend the scene visibly. */
const WIDE = 1.15;
/** Below this confidence, a result is rather wrong than right. */
const DOUBT = 0.5;

const changed = (title: string, apply: (inputs: Inputs) => Inputs): Remedy => ({
  ...{ title, needsFiles: true },
  act: ({ fileActions }) => fileActions.peek()?.change(apply),
});

const choose = (what: string): Remedy => ({
  ...{ title: `Change the ${what} …`, needsFiles: true },
  act: ({ fileActions }) => fileActions.peek()?.edit(),
});

const readAs = (title: string, depthKind: DepthKind) => changed(title, (inputs) => ({ ...inputs, depthKind }));
const nearIsBright = readAs("Near is bright", "affine-invariant-disparity");
const nearIsDark = readAs("Near is dark", "affine-invariant");

const back: Remedy = {
  ...{ title: "Back to the result", needsFiles: false },
  act: (workspace, object) => applyAlternative(workspace, object, -1),
};

const freeSize: Remedy = {
  ...{ title: "Search without this size", needsFiles: false },
  act(workspace, object) {
    object.lockScale(false);
    return alignSelected(workspace);
  },
};

/** Metres per unit of depth that are usual, and how they are called. */
const units = [
  [1, "Metres"],
  [0.01, "Centimetres"],
  [0.001, "Millimetres"],
  [0.0002, "0.2 mm"],
  [0.0001, "0.1 mm"],
] as const;
/** Sizes and distances of objects that nobody would doubt, metres. */
const [USUAL_SIZE_M, USUAL_DISTANCE_M] = [
  [0.03, 0.6],
  [0.2, 5],
] as const;

/** The units in which the object would have a usual size. */
function otherUnits({ depthUnit, distanceM, extentM }: Findings): Remedy[] {
  const present = depthUnit.metres ?? 1;
  const isIn = (m: number, [least, most]: readonly [number, number]) => m >= least && m <= most;
  return units.flatMap(([unit, title]) => {
    const factor = unit / present;
    const [sizeM, awayM] = [extentM * factor, distanceM * factor];
    if (unit === present || !isIn(sizeM, USUAL_SIZE_M) || !isIn(awayM, USUAL_DISTANCE_M)) return [];
    const what = `${title}: ${centimetres(sizeM)} cm across, ${depth(awayM, null)} away`;
    return [changed(what, (inputs) => ({ ...inputs, depthScale: unit }))];
  });
}

const isRelative = ({ depthKind }: Findings) => depthKind.startsWith("affine");

/** The causes, the surest first. How the limits of overlaps were set: docs/design-history.md. */
const rows: readonly Row[] = [
  {
    cause: "moved",
    test: ({ isByHand, visibleIou, foundIou, iou }) =>
      isByHand && visibleIou < WRONG_IOU && foundIou !== null && foundIou > iou + 0.15,
    text: ({ iou, foundIou }) =>
      `Moved by hand, the object overlaps its mask by ${percent(iou)}; where the alignment had put it, by ${percent(foundIou ?? 0)}.`,
    remedies: () => [back],
  },
  {
    cause: "mask",
    codes: ["MASK_LOOKS_INVERTED", "MASK_COVERS_IMAGE", "MASK_TOUCHES_BORDER"],
    test: has("MASK_LOOKS_INVERTED", "MASK_COVERS_IMAGE"),
    text: () => "The mask covers the border of the image: it seems to mark the background instead of the object.",
    remedies: ({ index }) => [changed("Invert the mask", withInverted(index)), choose("mask")],
  },
  {
    cause: "camera",
    codes: ["MESH_DOUBTFUL", "SIZE_DOUBTFUL"],
    test: ({ cameraFactor, confidence }) => cameraFactor !== null && confidence < SURE,
    text: () =>
      "The principal point is far from the middle: the intrinsics seem to be those of an image of another size.",
    remedies: ({ camera, cameraFactor }) => [
      ...(cameraFactor === null
        ? []
        : [
            changed(`Scale them by ${significant(cameraFactor, 3)}`, (inputs) => ({
              ...inputs,
              camera: scaled(camera, cameraFactor),
            })),
          ]),
      choose("camera"),
    ],
  },
  {
    cause: "size",
    codes: ["MESH_DOUBTFUL", "SCALE_CLAMPED"],
    test: ({ isSizeKnown, isByHand, confidence }) => isSizeKnown && !isByHand && confidence < DOUBT,
    text: () => "With the size that was entered, the mesh does not fit. Check the number and its edge.",
    remedies: () => [freeSize],
  },
  {
    cause: "mirrored",
    codes: ["MESH_LOOKS_MIRRORED", "MESH_DOUBTFUL"],
    test: has("MESH_LOOKS_MIRRORED"),
    text: () => "The mirror image of the mesh fits far better. Export it again: some exporters exchange two axes.",
    remedies: () => [choose("mesh")],
  },
  {
    cause: "depth",
    codes: ["DEPTH_LOOKS_NORMALISED", "DEPTH_LOOKS_INVERTED", "MESH_DOUBTFUL", "SIZE_DOUBTFUL"],
    test: (of) => of.isMetric && !isRelative(of) && has("DEPTH_LOOKS_NORMALISED")(of),
    text: () => "The depth map spans its whole range, as one that was normalised: its values are no lengths.",
    remedies: () => [nearIsBright, nearIsDark],
  },
  {
    cause: "depth",
    codes: ["DEPTH_LOOKS_INVERTED", "MESH_DOUBTFUL", "SIZE_DOUBTFUL"],
    // Real sensors have such outlines, too, where something hides the object.
    test: (of) => !isRelative(of) && has("DEPTH_LOOKS_INVERTED")(of) && of.confidence < DOUBT,
    text: () =>
      "At the outline, the surroundings are nearer than the object: near seems to be large in this depth map.",
    remedies: () => [readAs("Read it as disparity", "affine-invariant-disparity"), choose("depth map")],
  },
  {
    cause: "depth",
    codes: ["DEPTH_LOOKS_INVERTED", "MESH_DOUBTFUL"],
    test: (of) => isRelative(of) && (has("DEPTH_LOOKS_INVERTED")(of) || of.confidence < DOUBT),
    text: ({ depthKind }) =>
      `Read as relative depth of which near is ${depthKind === "affine-invariant" ? "dark" : "bright"}, the depth map does not fit the mesh.`,
    remedies: ({ depthKind }) => [depthKind === "affine-invariant" ? nearIsBright : nearIsDark, choose("depth map")],
  },
  {
    cause: "unit",
    codes: ["DEPTH_LOOKS_LIKE_MILLIMETRES", "DEPTH_LOOKS_TOO_SMALL", "SIZE_DOUBTFUL"],
    test: has("DEPTH_LOOKS_LIKE_MILLIMETRES", "DEPTH_LOOKS_TOO_SMALL", "SIZE_DOUBTFUL"),
    text: ({ depthUnit, distanceM, extentM }) =>
      `Is it really ${centimetres(extentM)} cm across and ${depth(distanceM, null)} away? The depth map does not state its unit; it was read in ${unitText(depthUnit)}.`,
    remedies: (of) => [...otherUnits(of), choose("unit")],
  },
  {
    cause: "texture",
    codes: ["TEXTURE_LOOKS_FLIPPED"],
    test: has("TEXTURE_LOOKS_FLIPPED"),
    text: () => "The photo shows the print of the mesh upside down, so the turn is in doubt. Export the mesh again.",
    remedies: () => [choose("mesh")],
  },
  {
    cause: "mask",
    // A thin object that lies on the surface fits its mask and depth.
    test: ({ bulge, step, confidence, isByHand }) => bulge < 0.05 && step < 0.045 && (isByHand || confidence < 0.7),
    text: () => "The mask shows a flat surface that goes on around it, not an object.",
    remedies: () => [choose("mask")],
  },
  {
    cause: "occluded",
    test: (of) =>
      of.isBehindSomething &&
      of.visibleIou >= LOW_IOU &&
      of.hidden > 0.1 &&
      of.residual < 0.04 &&
      !has("MESH_DOUBTFUL")(of),
    text: ({ hidden }) => `The overlap is low because ${percent(hidden)} of the object is behind something else.`,
  },
  {
    cause: "mesh",
    codes: ["MESH_DOUBTFUL"],
    test: (of) => !of.isByHand && has("MESH_DOUBTFUL")(of) && of.confidence < DOUBT,
    text: () =>
      "Even the best pose fits poorly: the mesh may be that of another object, or mask, depth map and camera do not belong together.",
    remedies: () => [choose("files")],
  },
  {
    cause: "depth",
    test: ({ depthKind, isMetric, confidence, isByHand, wideness }) =>
      depthKind === "metric" && isMetric && !isByHand && confidence < 0.8 && wideness > WIDE,
    text: ({ wideness }) =>
      `Is it depth? Some renderers and models write distances along the rays, which are up to ${percent(wideness - 1)} longer in this image.`,
    remedies: () => [readAs("Read it as distances along the rays", "ray-distance")],
  },
];

/** How much larger one image of a camera usually is than another one. */
const usual = [1 / 4, 1 / 3, 3 / 8, 1 / 2, 2 / 3, 3 / 4, 4 / 3, 3 / 2, 2, 8 / 3, 3, 4];
/** How far principal points are from the middle, relative. */
const TOLERANCE = 0.08;

/** The factor that brings the principal point to the middle, if intrinsics seem to be those of an image of another size. */
function otherSize(camera: Scene["camera"], size: ImageSize): number | null {
  if (doubtOfSize(camera, size) === undefined) return null;
  const factors = [size.width / (2 * camera.cx + 1), size.height / (2 * camera.cy + 1)];
  const isNear = (factor: number) => factors.every((one) => Math.abs(one / factor - 1) < TOLERANCE);
  return usual.find(isNear) ?? null;
}

/** Intrinsics scaled by a factor. Pixel centres are at integers. */
const scaled = ({ fx, fy, cx, cy }: Scene["camera"], factor: number): CameraSource => ({
  ...{ kind: "numbers", fx: factor * fx, fy: factor * fy },
  ...{ cx: factor * (cx + 0.5) - 0.5, cy: factor * (cy + 0.5) - 0.5 },
});

function has(...codes: readonly WarningCode[]) {
  return ({ warnings }: Findings) => codes.some((code) => warnings.includes(code));
}

/** Each pose has metrics of its own. */
const adviceByMetrics = new WeakMap<Metrics, Advice | null>();

/** The advice on the present pose of an object, once its metrics are known. */
export function adviceFor(scene: Scene, object: ObjectModel): Advice | null {
  const metrics = object.metrics.value;
  if (metrics === null) return null;
  const known = adviceByMetrics.get(metrics);
  if (known !== undefined) return known;
  const findings = findingsOf(scene, object, metrics);
  const row = rows.find(({ test }) => test(findings));
  const { cause, codes = [], remedies = () => [] } = row ?? {};
  const advice =
    row === undefined || cause === undefined
      ? null
      : { cause, codes, text: row.text(findings), remedies: remedies(findings) };
  adviceByMetrics.set(metrics, advice);
  return advice;
}

function findingsOf(scene: Scene, object: ObjectModel, metrics: Metrics): Findings {
  const { alignment, confidence, knownScale, pose } = object;
  const { camera, cameraSource, depthUnit, objects, raw } = scene;
  const index = objects.indexOf(object);
  return {
    ...evidenceOf(scene, object),
    ...{ index, camera, depthUnit, isMetric: isMetric(scene), depthKind: raw?.depthKind ?? "metric" },
    isByHand: !isResult(pose.value.source),
    isSizeKnown: knownScale.value !== null,
    iou: metrics.iou ?? 0,
    foundIou: alignment.value?.metrics.iou ?? null,
    confidence: confidence ?? 1,
    warnings: alignment.value?.warnings.map(({ code }) => code) ?? [],
    wideness: Math.hypot(1, ...[camera.cx / camera.fx, camera.cy / camera.fy]),
    cameraFactor: cameraSource === null ? otherSize(camera, scene) : null,
  };
}
