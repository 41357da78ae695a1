/** Human-readable tables of results. */
import type { AlignResult, Evaluation, LayoutErrors, Metrics, PoseErrors, Stretch, Warning } from "../index.js";
import { depthRows } from "./depth-rows.js";
import { isMetric, Lengths } from "./lengths.js";
import { type Failure, failedLine, type Outcome, type Success, type ViewsSuccess } from "./outcome.js";
import type { Style } from "./style.js";
import { type Column, fixed, headings, pairs, type Row, significant, tableLine, textWidth } from "./table.js";

const number = (heading: string): Column => ({ heading, isNumber: true, width: 6 });

/** The metrics in tables: heading, name, and number of decimals. Those in millimetres need metric lengths. */
const metricColumns = [
  ["IoU", "iou", 3],
  ["bound. F", "boundaryF", 3],
  ["drift px", "centerDriftPx", 1],
  ["Chamfer mm", "chamferMm", 2],
  ["fitness", "fitness", 3],
  ["MAE mm", "depthMaeMm", 2],
] as const;

type Metric = (typeof metricColumns)[number][1];

const metricHeadings = metricColumns.map(([heading]) => number(heading));
const metricCells = (lengths: Lengths, read: (metric: Metric) => number | null | undefined): string[] =>
  metricColumns.map(([, metric, digits]) =>
    metric.endsWith("Mm") ? lengths.cell(read(metric), digits) : fixed(read(metric), digits),
  );

const errorHeadings: readonly Column[] = ["Δscale %", "Δrot °", "Δtrans mm", "Δtrans %"].map(number);

/** Writes the lines of a table, whose columns do not depend on the results. The first row is preceded by the headings. */
export type RowLines<T> = (name: string, result: T | Failure) => string[];

function tableOf<T extends object>(
  names: readonly string[],
  columns: readonly Column[],
  style: Style,
  cells: (result: T) => string[],
): RowLines<T> {
  const width = names.reduce((widest, name) => Math.max(widest, textWidth(name)), 0);
  const all = [{ heading: "case", width }, ...columns];
  let isEmpty = true;
  return (name, result) => {
    const row = "error" in result ? [style.red((result as Failure).error.code)] : cells(result as T);
    const first = isEmpty ? [style.bold(headings(all))] : [];
    isEmpty = false;
    return [...first, tableLine(all, [name, ...row])];
  };
}

/** The table of several cases; the errors have columns if a case has a true pose. */
export function summaryTable(
  cases: readonly { name: string; hasTruth: boolean }[],
  style: Style,
): RowLines<Success | ViewsSuccess> {
  const hasTruth = cases.some((each) => each.hasTruth);
  const columns = [
    ...["conf.", "alt."].map(number),
    { ...number("scale"), width: 9 },
    number("s/s_init"),
    ...metricHeadings,
    number("time s"),
    ...(hasTruth ? errorHeadings : []),
  ];
  const names = cases.map(({ name }) => name);
  return tableOf(names, columns, style, (outcome) => {
    const cells = "views" in outcome ? viewsCells(outcome) : caseCells(outcome);
    return hasTruth ? [...cells, ...errorCells("views" in outcome ? null : outcome.errors)] : cells;
  });
}

/** The table of several evaluations. */
export function evaluationTable(names: readonly string[], lengths: Lengths, style: Style): RowLines<Evaluation> {
  const cells = ({ metrics, errors }: Evaluation) => [
    ...metricCells(lengths, (metric) => metrics[metric]),
    ...errorCells(errors, lengths),
  ];
  return tableOf(names, [...metricHeadings, ...errorHeadings], style, cells);
}

function caseCells({ alignment }: Success): string[] {
  const { scale, metrics, diagnostics } = alignment;
  const { scaleRatio, timingsMs } = diagnostics;
  const certain = "confidence" in alignment ? alignment : null;
  return [
    fixed(certain?.confidence, 2),
    certain === null ? "–" : String(certain.alternatives.length),
    significant(scale, 4),
    fixed(scaleRatio, 3),
    ...metricCells(new Lengths(isMetric(alignment)), (metric) => metrics?.[metric]),
    fixed(timingsMs.total / 1000, 2),
  ];
}

/** Of the metrics, the means over the views that have them. */
function viewsCells({ views: alignment }: ViewsSuccess): string[] {
  const { confidence, alternatives, scale, views, diagnostics } = alignment;
  const mean = (metric: Metric) => {
    const values = views.flatMap(({ metrics }) => metrics?.[metric] ?? []);
    return values.length === 0 ? null : values.reduce((sum, value) => sum + value, 0) / values.length;
  };
  return [
    fixed(confidence, 2),
    String(alternatives.length),
    significant(scale, 4),
    "–",
    ...metricCells(new Lengths(isMetric(alignment)), mean),
    fixed(diagnostics.timingsMs.total / 1000, 2),
  ];
}

/** Details of a case of several views. */
export function viewsDetails({ name, views: alignment, frames, errors }: ViewsSuccess, style: Style): string[] {
  const { scale, translation, rotation, world, confidence, uncertainty, views, warnings, diagnostics } = alignment;
  const frame = world === "given" ? "world" : "camera of the first view that is used";
  const numbers = (values: readonly number[]) => values.map((x) => fixed(x, 6)).join("  ");
  const { unit } = new Lengths(isMetric(alignment));
  const view = (frameName: string, k: number): Row[] => {
    const { confidence, role, metrics, ...ofInput } = views[k] as (typeof views)[number];
    const read = depthRows(ofInput).map(([name, value]): Row => ["", `${name}: ${value}`]);
    const own = errors[k] ?? null;
    const error =
      own === null
        ? ""
        : `, errors: scale ${fixed(100 * own.scaleError, 2)} %, rotation ${fixed(own.rotationErrorDeg, 2)}°, translation ${fixed(100 * own.translationErrorRelative, 2)} %`;
    return [[frameName, `${role}, confidence ${fixed(confidence, 2)}, IoU ${fixed(metrics?.iou, 3)}${error}`], ...read];
  };
  return [
    style.bold(`${name}: ${frame} from mesh, x = s·R·p + t`),
    ...pairs([
      [
        "scale s",
        `${significant(scale, 6)} ${unit} per mesh unit${uncertainty === null ? "" : ` ± ${fixed(100 * uncertainty.scale, 2)} %`}`,
      ],
      ["translation t", `${numbers(translation)} ${unit}`],
      ["rotation R", `${numbers(rotation)} (quaternion x y z w)`],
      ["confidence", `${fixed(confidence, 2)}, score ${fixed(diagnostics.score, 3)}`],
      ...proportionsRows(alignment, new Lengths(isMetric(alignment))),
    ]),
    "",
    style.bold("Views"),
    ...pairs(frames.flatMap(view)),
    ...warningsSection([...warnings, ...views.flatMap((each) => each.warnings)], style),
  ];
}

/** Errors of an alignment are known for metric lengths only. */
function errorCells(errors: PoseErrors | null, lengths = new Lengths(true)): string[] {
  if (errors === null) return errorHeadings.map(() => "–");
  return [
    fixed(100 * errors.scaleError, 1),
    fixed(errors.rotationErrorDeg, 1),
    lengths.cell(1000 * errors.translationErrorM, 1),
    fixed(100 * errors.translationErrorRelative, 1),
  ];
}

/** Details of an aligned case. */
export function details({ name, alignment, errors }: Success, style: Style): string[] {
  const { scale, rotation, rotationMatrix, translation, metrics, diagnostics } = alignment;
  const matrixRow = (i: 0 | 1 | 2) =>
    [...rotationMatrix[i].map((r) => r * scale), translation[i]].map((x) => fixed(x, 6).padStart(11)).join("");
  const lengths = new Lengths(isMetric(alignment));
  return [
    style.bold(`${name}: camera from mesh, x_cam = s·R·p + t`),
    ...pairs([
      ["scale s", `${significant(scale, 6)} ${lengths.unit} per mesh unit`],
      ["scale ratio", `${fixed(diagnostics.scaleRatio, 4)} of the initial ${significant(diagnostics.initialScale, 6)}`],
      ["translation t", `${translation.map((x) => fixed(x, 6)).join("  ")} ${lengths.unit}`],
      ["rotation R", `${rotation.map((x) => fixed(x, 6)).join("  ")} (quaternion x y z w)`],
      ["matrix (s·R | t)", matrixRow(0)],
      ["", matrixRow(1)],
      ["", matrixRow(2)],
      ...("confidence" in alignment ? certainty(alignment, lengths) : [refinement(alignment, lengths)]),
      ...proportionsRows(alignment, lengths),
      ...depthRows(alignment),
    ]),
    ...(metrics === undefined ? [] : ["", ...metricsSection(metrics, lengths, style)]),
    ...errorsSection(errors, lengths, style),
    "",
    style.bold("Stages"),
    ...pairs(Object.entries(diagnostics.timingsMs).map(([stage, ms]) => [stage, `${fixed(ms, 1).padStart(8)} ms`])),
    "",
    style.bold("Counts"),
    ...pairs(countRows(alignment)),
    ...warningsSection(alignment.warnings, style),
  ];
}

/** The lengths of a mesh in the proportions that were found. */
export function proportionsRows(alignment: object, lengths: Lengths): Row[] {
  const { proportions } = alignment as { proportions?: Stretch };
  if (proportions === undefined) return [];
  const { sizeM, uncertainty } = proportions;
  const sides = sizeM.map((size, k) => {
    const sd = `± ${fixed(100 * (uncertainty[k as 0] ?? 0), 1)} %`;
    return `${"xyz"[k]} ${lengths.millimetres(1000 * size, 1)} ${sd}`;
  });
  return [["in proportion", sides.join(", ")]];
}

function refinement({ diagnostics: { converged, residualM } }: AlignResult<"paper">, lengths: Lengths): Row {
  const residual = lengths.millimetres(1000 * residualM, 3);
  return ["refinement", `${converged ? "converged" : "did not converge"}, residual ${residual}`];
}

/** Confidence, alternatives and uncertainty. */
function certainty(
  { confidence, alternatives, uncertainty, diagnostics }: AlignResult<"precise">,
  lengths: Lengths,
): Row[] {
  const { score } = diagnostics;
  const others = alternatives.map((other) => `${fixed(other.turnDeg, 0)}° (score ${fixed(other.score, 3)})`);
  const rows: Row[] = [
    ["confidence", `${fixed(confidence, 2)}, score ${fixed(score, 3)}`],
    ["alternatives", others.length === 0 ? "none" : `${others.length}, rotated by ${others.join(", ")}`],
  ];
  if (uncertainty === null) return rows;
  const { scale, rotationDeg, rotationAxis, lateralM, distanceM } = uncertainty;
  const axis = rotationAxis.map((x) => fixed(x, 2)).join(" ");
  const [lateral, distance] = [lateralM, distanceM].map((length) => lengths.millimetres(1000 * length, 1));
  const shift = `${lateral} lateral, ${distance} in distance`;
  return [
    ...rows,
    ["uncertainty", `scale ${fixed(100 * scale, 1)} %, rotation ${fixed(rotationDeg, 1)}° about ${axis}, ${shift}`],
  ];
}

function countRows({ diagnostics: { counts } }: AlignResult): Row[] {
  const points: Row = ["points", `${counts.sourcePoints} on the mesh, ${counts.targetPoints} observed`];
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

/** Details of an evaluated case. */
export function evaluationDetails(name: string, evaluation: Evaluation, lengths: Lengths, style: Style): string[] {
  const { metrics, errors, layout, warnings, diagnostics } = evaluation;
  const { scaleRatio, initialScale, collapsed } = diagnostics;
  return [
    style.bold(`${name}: evaluation`),
    ...pairs([
      [
        "scale ratio",
        `${fixed(scaleRatio, 4)} of the initial ${significant(initialScale, 6)}${collapsed ? ", collapsed" : ""}`,
      ],
      ...depthRows(evaluation),
    ]),
    "",
    ...metricsSection(metrics, lengths, style),
    ...errorsSection(errors, lengths, style),
    ...layoutSection(layout, lengths, style),
    ...warningsSection(warnings, style),
  ];
}

function metricsSection(metrics: Metrics, lengths: Lengths, style: Style): string[] {
  return [
    style.bold("Metrics"),
    ...pairs([
      ["silhouette IoU", fixed(metrics.iou, 4)],
      ["boundary F", fixed(metrics.boundaryF, 4)],
      ["centre drift", `${fixed(metrics.centerDriftPx, 2)} px`],
      ["Chamfer", `${lengths.millimetres(metrics.chamferMm, 3)} (both directions)`],
      ["uni-Chamfer", `${lengths.millimetres(metrics.uniChamferMm, 3)} (observed to surface)`],
      ["fitness", fixed(metrics.fitness, 4)],
      ["normal consistency", fixed(metrics.normalConsistency, 4)],
      ["depth MAE", lengths.millimetres(metrics.depthMaeMm, 3)],
    ]),
  ];
}

function errorsSection(errors: PoseErrors | null, lengths: Lengths, style: Style): string[] {
  if (errors === null) return [];
  const { scaleError, rotationErrorDeg, translationErrorM, translationErrorRelative, addSMm } = errors;
  return [
    "",
    style.bold("Errors (compared with gt.json)"),
    ...pairs([
      ["scale", `${fixed(100 * scaleError, 2)} %`],
      ["rotation", `${fixed(rotationErrorDeg, 2)}°`],
      [
        "translation",
        `${lengths.millimetres(1000 * translationErrorM, 2)}, ${fixed(100 * translationErrorRelative, 2)} % of the diameter`,
      ],
      ["ADD-S", lengths.millimetres(addSMm, 2)],
    ]),
  ];
}

function layoutSection(layout: LayoutErrors | null, { isMetric }: Lengths, style: Style): string[] {
  if (layout === null) return [];
  const { boxIou, icpRotationDeg, addSRelative, isFound, isCadAligned } = layout;
  return [
    "",
    style.bold("Layout"),
    ...pairs([
      ["3D IoU", fixed(boxIou, 4)],
      ["ICP-Rot", `${fixed(icpRotationDeg, 2)}°`],
      ["ADD-S", `${fixed(100 * addSRelative, 2)} % of the diameter${isFound ? "" : ", not found"}`],
      ...(isMetric ? [["20 cm, 20°, 20 %", isCadAligned ? "aligned" : "not aligned"] as const] : []),
    ]),
  ];
}

function warningsSection(warnings: readonly Warning[], style: Style): string[] {
  if (warnings.length === 0) return [];
  return ["", style.bold("Warnings"), ...warnings.map((warning) => `  ${warningText(warning, style)}`)];
}

const warningText = ({ code, message }: Warning, style: Style) => `${style.yellow(code)}: ${message}`;

/** Warnings and failures of several cases. */
export function notes(outcomes: readonly Outcome[], style: Style): string[] {
  return outcomes.flatMap((outcome) =>
    "error" in outcome
      ? [failedLine(outcome, style)]
      : ("views" in outcome ? outcome.views : outcome.alignment).warnings.map(
          (warning) => `${outcome.name}: ${warningText(warning, style)}`,
        ),
  );
}
