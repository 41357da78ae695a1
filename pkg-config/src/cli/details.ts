/** Details of a single case, for people. */
import type { Stretch } from "../generated/types.js";
import type { Alignment, DepthCalibration, Evaluation, Metrics, PaperAlignment, PoseErrors } from "../index.js";
import { unitText } from "../input/depth-kinds.js";
import type { InputInfo } from "../types/results.js";
import { type AlignEntry, type Entry, isMetric, type ViewsEntry, warningsOf } from "./entry.js";
import { fixed, type Message, significant } from "./row.js";
import { Lengths, type Pair, pairs } from "./table.js";
import type { Style } from "./terminal.js";

const numbers = (values: readonly number[], digits: number, between: string) =>
  values.map((x) => fixed(x, digits)).join(between);
const percent = (share: number, digits: number) => `${fixed(100 * share, digits)} %`;

const section = (title: string, entries: readonly Pair[], style: Style) => ["", style.bold(title), ...pairs(entries)];

export const warningLine = ({ code, message }: Message, style: Style) => `${style.yellow(code)}: ${message}`;

function warningSection(warnings: readonly Message[], style: Style): string[] {
  if (warnings.length === 0) return [];
  return ["", style.bold("Warnings"), ...warnings.map((warning) => `  ${warningLine(warning, style)}`)];
}

/** Details of an aligned case. */
export function alignDetails(name: string, entry: AlignEntry, style: Style): string[] {
  const { scale, rotation, rotationMatrix, translation, metrics, errors, diagnostics } = entry;
  const lengths = new Lengths(isMetric(entry));
  const matrixRow = (i: 0 | 1 | 2) =>
    [...rotationMatrix[i].map((r) => r * scale), translation[i]].map((x) => fixed(x, 6).padStart(11)).join("");
  const { scaleRatio, initialScale } = diagnostics;
  return [
    style.bold(`${name}: camera from mesh, x_cam = s·R·p + t`),
    ...pairs([
      ["scale s", `${significant(scale, 6)} ${lengths.unit} per mesh unit`],
      ["scale ratio", `${fixed(scaleRatio, 4)} of the initial ${significant(initialScale, 6)}`],
      ["translation t", `${numbers(translation, 6, "  ")} ${lengths.unit}`],
      ["rotation R", `${numbers(rotation, 6, "  ")} (quaternion x y z w)`],
      ["matrix (s·R | t)", matrixRow(0)],
      ["", matrixRow(1)],
      ["", matrixRow(2)],
      ...("confidence" in entry ? certainty(entry, lengths) : refinement(entry.diagnostics, lengths)),
      ...proportionsRows(entry, lengths),
      ...depthRows(entry),
    ]),
    ...metricsSection(metrics, lengths, style),
    ...errorsSection(errors, lengths, style),
    ...section(
      "Stages",
      Object.entries(diagnostics.timingsMs).map(([stage, ms]) => [stage, `${fixed(ms, 1).padStart(8)} ms`]),
      style,
    ),
    ...section("Counts", countRows(diagnostics), style),
    ...warningSection(entry.warnings, style),
  ];
}

/** The outcome of the refinement of preset `paper`. */
function refinement({ converged, residualM }: PaperAlignment["diagnostics"], lengths: Lengths): Pair[] {
  const residual = lengths.small(residualM, 3);
  return [["refinement", `${converged ? "converged" : "did not converge"}, residual ${residual}`]];
}

/** Confidence, alternatives and uncertainty. */
function certainty(
  { confidence, alternatives, uncertainty, diagnostics: { score } }: Omit<Alignment, "metrics">,
  lengths: Lengths,
): Pair[] {
  const others = alternatives.map((other) => `${fixed(other.turnDeg, 0)}° (score ${fixed(other.score, 3)})`);
  const rows: Pair[] = [
    ["confidence", `${fixed(confidence, 2)}, score ${fixed(score, 3)}`],
    ["alternatives", others.length === 0 ? "none" : `${others.length}, rotated by ${others.join(", ")}`],
  ];
  if (uncertainty === null) return rows;
  const { scale, rotationDeg, rotationAxis, lateralM, distanceM } = uncertainty;
  const turn = `rotation ${fixed(rotationDeg, 1)}° about ${numbers(rotationAxis, 2, " ")}`;
  const [lateral, distance] = [lateralM, distanceM].map((length) => lengths.small(length, 1));
  const text = `scale ${percent(scale, 1)}, ${turn}, ${lateral} lateral, ${distance} in distance`;
  return [...rows, ["uncertainty", text]];
}

function countRows({ counts }: AlignEntry["diagnostics"]): Pair[] {
  const points: Pair = ["points", `${counts.sourcePoints} on the mesh, ${counts.targetPoints} observed`];
  if ("renders" in counts) return [points, ["renders", String(counts.renders)]];
  return [
    points,
    ["voxels", `${counts.sourceVoxels} and ${counts.targetVoxels}`],
    ["matches", `${counts.matches}, of which ${counts.inliers} agree`],
    ["hypotheses", `${counts.iterations} drawn, ${counts.inconsistent} inconsistent`],
    ["scale guard", `${counts.rejected} rejected, ${counts.clamped} clamped`],
    ["refinement", `${counts.icpIterations} iterations, ${counts.supported} points supported`],
  ];
}

/** Details of a case of several views. */
export function viewsDetails(name: string, entry: ViewsEntry, style: Style): string[] {
  const { scale, rotation, translation, world, views, confidence, uncertainty, diagnostics } = entry;
  const place = world === "given" ? "world" : "camera of the first view that is used";
  const lengths = new Lengths(isMetric(entry));
  const view = ({ name, role, confidence: certain, metrics, errors, ...input }: (typeof views)[number]): Pair[] => {
    const error =
      errors === undefined
        ? ""
        : `, errors: scale ${percent(errors.scaleError, 2)}, rotation ${fixed(errors.rotationErrorDeg, 2)}°, translation ${percent(errors.translationErrorRelative, 2)}`;
    return [
      [name, `${role}, confidence ${fixed(certain, 2)}, IoU ${fixed(metrics?.iou, 3)}${error}`],
      ...depthRows(input).map(([row, value]): Pair => ["", `${row}: ${value}`]),
    ];
  };
  const sd = uncertainty === null ? "" : ` ± ${percent(uncertainty.scale, 2)}`;
  return [
    style.bold(`${name}: ${place} from mesh, x = s·R·p + t`),
    ...pairs([
      ["scale s", `${significant(scale, 6)} ${lengths.unit} per mesh unit${sd}`],
      ["translation t", `${numbers(translation, 6, "  ")} ${lengths.unit}`],
      ["rotation R", `${numbers(rotation, 6, "  ")} (quaternion x y z w)`],
      ["confidence", `${fixed(confidence, 2)}, score ${fixed(diagnostics.score, 3)}`],
      ...proportionsRows(entry, lengths),
    ]),
    ...section("Views", views.flatMap(view), style),
    ...warningSection([...entry.warnings, ...views.flatMap((each) => each.warnings)], style),
  ];
}

/** An entry of views for a table: its metrics are the means over the views that have them. */
export function withMeans(entry: Entry): Entry {
  const { views } = entry;
  if (!Array.isArray(views)) return entry;
  const sums = new Map<string, { sum: number; count: number }>();
  for (const { metrics } of views as { metrics?: Entry }[]) {
    for (const [name, value] of Object.entries(metrics ?? {})) {
      const { sum, count } = sums.get(name) ?? { sum: 0, count: 0 };
      if (typeof value === "number") sums.set(name, { sum: sum + value, count: count + 1 });
    }
  }
  const means = [...sums].map(([name, { sum, count }]) => [name, sum / count]);
  return { ...entry, metrics: Object.fromEntries(means) };
}

/** Details of an evaluated case. */
export function evaluationDetails(name: string, entry: Entry, style: Style): string[] {
  const { metrics, errors, diagnostics, ...input } = entry as unknown as Evaluation;
  const { scaleRatio, initialScale, collapsed } = diagnostics;
  const lengths = new Lengths(isMetric(entry));
  const ratio = `${fixed(scaleRatio, 4)} of the initial ${significant(initialScale, 6)}`;
  return [
    style.bold(`${name}: evaluation`),
    ...pairs([["scale ratio", `${ratio}${collapsed ? ", collapsed" : ""}`], ...depthRows(input)]),
    ...metricsSection(metrics, lengths, style),
    ...errorsSection(errors, lengths, style),
    ...warningSection(warningsOf(entry), style),
  ];
}

function metricsSection(metrics: Metrics | undefined, lengths: Lengths, style: Style): string[] {
  if (metrics === undefined) return [];
  const rows: Pair[] = [
    ["silhouette IoU", fixed(metrics.iou, 4)],
    ["boundary F", fixed(metrics.boundaryF, 4)],
    ["centre drift", `${fixed(metrics.centerDriftPx, 2)} px`],
    ["Chamfer", `${lengths.small(metrics.chamferM, 3)} (both directions)`],
    ["uni-Chamfer", `${lengths.small(metrics.uniChamferM, 3)} (observed to surface)`],
    ["fitness", fixed(metrics.fitness, 4)],
    ["normal consistency", fixed(metrics.normalConsistency, 4)],
    ["depth MAE", lengths.small(metrics.depthMaeM, 3)],
  ];
  return section("Metrics", rows, style);
}

function errorsSection(errors: PoseErrors | null | undefined, lengths: Lengths, style: Style): string[] {
  if (errors === null || errors === undefined) return [];
  const { scaleError, rotationErrorDeg, translationErrorM, translationErrorRelative, addSM } = errors;
  const shift = `${lengths.small(translationErrorM, 2)}, ${percent(translationErrorRelative, 2)}`;
  const rows: Pair[] = [
    ["scale", percent(scaleError, 2)],
    ["rotation", `${fixed(rotationErrorDeg, 2)}°`],
    ["translation", `${shift} of the diameter`],
    ["ADD-S", lengths.small(addSM, 2)],
  ];
  return section("Errors (compared with gt.json)", rows, style);
}

/** The lengths of a mesh in the proportions that were found. */
export function proportionsRows(alignment: object, lengths: Lengths): Pair[] {
  const { proportions } = alignment as { proportions?: Pick<Stretch, "sizeM" | "uncertainty"> };
  if (proportions === undefined) return [];
  const { sizeM, uncertainty } = proportions;
  const sides = sizeM.map(
    (size, k) => `${"xyz"[k]} ${lengths.small(size, 1)} ± ${percent(uncertainty[k as 0] ?? 0, 1)}`,
  );
  return [["in proportion", sides.join(", ")]];
}

/** The readings of depth and camera: the unit of the depth, its calibration, and where the camera comes from. */
export function depthRows({ depthUnit, cameraSource, depthCalibration }: InputInfo): Pair[] {
  const rows: Pair[] = depthUnit === undefined ? [] : [["depth unit", unitText(depthUnit)]];
  if (depthCalibration !== undefined)
    rows.push(
      ["depth", depthText(depthCalibration)],
      ["focal length", focalText(depthCalibration, cameraSource ?? "given")],
    );
  else if (cameraSource !== undefined) rows.push(["camera", cameraSource]);
  return rows;
}

function depthText({ depthKind, scale, shift, uncertainty }: DepthCalibration): string {
  const s = significant(scale, 4);
  const shifted = `(d ${shift < 0 ? "−" : "+"} ${significant(Math.abs(shift), 4)})`;
  const z = {
    metric: "d",
    "scale-invariant": `${s}·d`,
    "affine-invariant": `${s}·${shifted}`,
    "affine-invariant-disparity": `${s} / ${shifted}`,
  }[depthKind];
  const sd = uncertainty.shift === 0 ? "" : `, ± ${percent(uncertainty.shift, 1)} of the distance`;
  return `${depthKind}, z = ${z}${sd}`;
}

function focalText({ camera, isFocalEstimated, uncertainty }: DepthCalibration, source: string): string {
  const { fx, fy } = camera;
  const pixels = fx === fy ? `${fixed(fx, 1)} px` : `${fixed(fx, 1)} × ${fixed(fy, 1)} px`;
  return isFocalEstimated ? `${pixels} ± ${percent(uncertainty.focal, 1)}, ${source}` : `${pixels}, ${source}`;
}
