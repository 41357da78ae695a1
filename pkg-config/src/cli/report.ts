/** Human-readable tables of results. */
import type { AlignResult, Evaluation, LayoutErrors, Metrics, PoseErrors, Warning } from "../index.js";
import { fixed, significant } from "./number.js";
import { type Failure, failureText, type Outcome, type Success, type ViewsSuccess } from "./outcome.js";
import type { Style } from "./style.js";
import { type Column, headings, pairs, tableLine, textWidth } from "./table.js";

const number = (heading: string): Column => ({ heading, isNumber: true, width: 6 });

const columns: readonly Column[] = [
  { heading: "case" },
  ...["conf.", "alt."].map(number),
  { ...number("scale"), width: 9 },
  ...["s/s_init", "IoU", "bound. F", "drift px", "Chamfer mm", "fitness", "MAE mm", "time s"].map(number),
];

const errorColumns: readonly Column[] = ["Δscale %", "Δrot °", "Δtrans mm", "Δtrans %"].map(number);

/** The table of several cases, one row per case, whose columns do not depend on the results. */
export class Summary {
  readonly #columns: readonly Column[];
  readonly #hasTruth: boolean;
  readonly #style: Style;
  #isEmpty = true;

  /** @param cases all cases of the table; the errors have columns if a case has a true pose */
  constructor(cases: readonly { name: string; hasTruth: boolean }[], style: Style) {
    this.#hasTruth = cases.some(({ hasTruth }) => hasTruth);
    const width = cases.reduce((widest, { name }) => Math.max(widest, textWidth(name)), 0);
    const all = this.#hasTruth ? [...columns, ...errorColumns] : columns;
    this.#columns = all.map((column, i) => (i === 0 ? { ...column, width } : column));
    this.#style = style;
  }

  /** The row of a case; the first one is preceded by the headings. */
  lines(outcome: Outcome): string[] {
    const cells =
      "error" in outcome
        ? [outcome.name, this.#style.red(outcome.error.code)]
        : "views" in outcome
          ? [...viewsRow(outcome), ...(this.#hasTruth ? errorCells(null) : [])]
          : [...row(outcome), ...(this.#hasTruth ? errorCells(outcome.errors) : [])];
    const lines = [tableLine(this.#columns, cells)];
    if (this.#isEmpty) lines.unshift(this.#style.bold(headings(this.#columns)));
    this.#isEmpty = false;
    return lines;
  }
}

/** The table of several evaluations. */
export class EvaluationSummary {
  readonly #columns: readonly Column[];
  readonly #style: Style;
  #isEmpty = true;

  constructor(cases: readonly { name: string }[], style: Style) {
    const width = cases.reduce((widest, { name }) => Math.max(widest, textWidth(name)), 0);
    const metrics = ["IoU", "bound. F", "drift px", "Chamfer mm", "fitness", "MAE mm"].map(number);
    this.#columns = [{ heading: "case", width }, ...metrics, ...errorColumns];
    this.#style = style;
  }

  /** The row of a case; the first one is preceded by the headings. */
  lines(name: string, result: Evaluation | Failure): string[] {
    const cells =
      "error" in result
        ? [name, this.#style.red(result.error.code)]
        : [name, ...metricCells(result.metrics), ...errorCells(result.errors)];
    const lines = [tableLine(this.#columns, cells)];
    if (this.#isEmpty) lines.unshift(this.#style.bold(headings(this.#columns)));
    this.#isEmpty = false;
    return lines;
  }
}

const metricCells = (metrics: Metrics | undefined): string[] => [
  fixed(metrics?.iou, 3),
  fixed(metrics?.boundaryF, 3),
  fixed(metrics?.centerDriftPx, 1),
  fixed(metrics?.chamferMm, 2),
  fixed(metrics?.fitness, 3),
  fixed(metrics?.depthMaeMm, 2),
];

function row({ name, alignment }: Success): string[] {
  const { scale, metrics, diagnostics } = alignment;
  const { scaleRatio, timingsMs } = diagnostics;
  const certain = "confidence" in alignment ? alignment : null;
  return [
    name,
    fixed(certain?.confidence, 2),
    certain === null ? "–" : String(certain.alternatives.length),
    significant(scale, 4),
    fixed(scaleRatio, 3),
    ...metricCells(metrics),
    fixed(timingsMs.total / 1000, 2),
  ];
}

function viewsRow({ name, views: alignment }: ViewsSuccess): string[] {
  const { confidence, alternatives, scale, views, diagnostics } = alignment;
  const mean = (metric: "iou" | "boundaryF" | "centerDriftPx" | "chamferMm" | "fitness" | "depthMaeMm") => {
    const values = views.flatMap(({ metrics }) => metrics?.[metric] ?? []);
    return values.length === 0 ? null : values.reduce((sum, value) => sum + value, 0) / values.length;
  };
  return [
    name,
    fixed(confidence, 2),
    String(alternatives.length),
    significant(scale, 4),
    "–",
    fixed(mean("iou"), 3),
    fixed(mean("boundaryF"), 3),
    fixed(mean("centerDriftPx"), 1),
    fixed(mean("chamferMm"), 2),
    fixed(mean("fitness"), 3),
    fixed(mean("depthMaeMm"), 2),
    fixed(diagnostics.timingsMs.total / 1000, 2),
  ];
}

/** Details of a case of several views. */
export function viewsDetails({ name, views: alignment, frames, errors }: ViewsSuccess, style: Style): string[] {
  const { scale, translation, rotation, world, confidence, uncertainty, views, warnings, diagnostics } = alignment;
  const frame = world === "given" ? "world" : "camera of the first view that is used";
  const numbers = (values: readonly number[]) => values.map((x) => fixed(x, 6)).join("  ");
  const view = (frameName: string, k: number): Row[] => {
    const { confidence, role, metrics } = views[k] as (typeof views)[number];
    const own = errors[k] ?? null;
    const error =
      own === null
        ? ""
        : `, errors: scale ${fixed(100 * own.scaleError, 2)} %, rotation ${fixed(own.rotationErrorDeg, 2)}°, translation ${fixed(100 * own.translationErrorRelative, 2)} %`;
    return [[frameName, `${role}, confidence ${fixed(confidence, 2)}, IoU ${fixed(metrics?.iou, 3)}${error}`]];
  };
  return [
    style.bold(`${name}: ${frame} from mesh, x = s·R·p + t`),
    ...pairs([
      [
        "scale s",
        `${significant(scale, 6)} m per mesh unit${uncertainty === null ? "" : ` ± ${fixed(100 * uncertainty.scale, 2)} %`}`,
      ],
      ["translation t", `${numbers(translation)} m`],
      ["rotation R", `${numbers(rotation)} (quaternion x y z w)`],
      ["confidence", `${fixed(confidence, 2)}, score ${fixed(diagnostics.score, 3)}`],
    ]),
    "",
    style.bold("Views"),
    ...pairs(frames.flatMap(view)),
    ...warningsSection([...warnings, ...views.flatMap((each) => each.warnings)], style),
  ];
}

function errorCells(errors: PoseErrors | null): string[] {
  if (errors === null) return errorColumns.map(() => "–");
  return [
    fixed(100 * errors.scaleError, 1),
    fixed(errors.rotationErrorDeg, 1),
    fixed(1000 * errors.translationErrorM, 1),
    fixed(100 * errors.translationErrorRelative, 1),
  ];
}

/** Details of an aligned case. */
export function details({ name, alignment, errors }: Success, style: Style): string[] {
  const { scale, rotation, rotationMatrix, translation, metrics, diagnostics } = alignment;
  const matrixRow = (i: 0 | 1 | 2) =>
    [...rotationMatrix[i].map((r) => r * scale), translation[i]].map((x) => fixed(x, 6).padStart(11)).join("");
  return [
    style.bold(`${name}: camera from mesh, x_cam = s·R·p + t`),
    ...pairs([
      ["scale s", `${significant(scale, 6)} m per mesh unit`],
      ["scale ratio", `${fixed(diagnostics.scaleRatio, 4)} of the initial ${significant(diagnostics.initialScale, 6)}`],
      ["translation t", `${translation.map((x) => fixed(x, 6)).join("  ")} m`],
      ["rotation R", `${rotation.map((x) => fixed(x, 6)).join("  ")} (quaternion x y z w)`],
      ["matrix (s·R | t)", matrixRow(0)],
      ["", matrixRow(1)],
      ["", matrixRow(2)],
      ...("confidence" in alignment ? certainty(alignment) : [refinement(alignment)]),
    ]),
    ...(metrics === undefined ? [] : ["", ...metricsSection(metrics, style)]),
    ...errorsSection(errors, style),
    "",
    style.bold("Stages"),
    ...pairs(Object.entries(diagnostics.timingsMs).map(([stage, ms]) => [stage, `${fixed(ms, 1).padStart(8)} ms`])),
    "",
    style.bold("Counts"),
    ...pairs(countRows(alignment)),
    ...warningsSection(alignment.warnings, style),
  ];
}

type Row = readonly [name: string, value: string];

function refinement({ diagnostics: { converged, residualM } }: AlignResult<"paper">): Row {
  return [
    "refinement",
    `${converged ? "converged" : "did not converge"}, residual ${significant(1000 * residualM, 3)} mm`,
  ];
}

/** Confidence, alternatives and uncertainty. */
function certainty({ confidence, alternatives, uncertainty, diagnostics }: AlignResult<"precise">): Row[] {
  const { score } = diagnostics;
  const others = alternatives.map((other) => `${fixed(other.turnDeg, 0)}° (score ${fixed(other.score, 3)})`);
  const rows: Row[] = [
    ["confidence", `${fixed(confidence, 2)}, score ${fixed(score, 3)}`],
    ["alternatives", others.length === 0 ? "none" : `${others.length}, rotated by ${others.join(", ")}`],
  ];
  if (uncertainty === null) return rows;
  const { scale, rotationDeg, rotationAxis, lateralM, distanceM } = uncertainty;
  const axis = rotationAxis.map((x) => fixed(x, 2)).join(" ");
  const shift = `${fixed(1000 * lateralM, 1)} mm lateral, ${fixed(1000 * distanceM, 1)} mm in distance`;
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
export function evaluationDetails(name: string, evaluation: Evaluation, style: Style): string[] {
  const { metrics, errors, layout, warnings, diagnostics } = evaluation;
  const { scaleRatio, initialScale, collapsed } = diagnostics;
  return [
    style.bold(`${name}: evaluation`),
    ...pairs([
      [
        "scale ratio",
        `${fixed(scaleRatio, 4)} of the initial ${significant(initialScale, 6)}${collapsed ? ", collapsed" : ""}`,
      ],
    ]),
    "",
    ...metricsSection(metrics, style),
    ...errorsSection(errors, style),
    ...layoutSection(layout, style),
    ...warningsSection(warnings, style),
  ];
}

function metricsSection(metrics: Metrics, style: Style): string[] {
  return [
    style.bold("Metrics"),
    ...pairs([
      ["silhouette IoU", fixed(metrics.iou, 4)],
      ["boundary F", fixed(metrics.boundaryF, 4)],
      ["centre drift", `${fixed(metrics.centerDriftPx, 2)} px`],
      ["Chamfer", `${fixed(metrics.chamferMm, 3)} mm (both directions)`],
      ["uni-Chamfer", `${fixed(metrics.uniChamferMm, 3)} mm (observed to surface)`],
      ["fitness", fixed(metrics.fitness, 4)],
      ["normal consistency", fixed(metrics.normalConsistency, 4)],
      ["depth MAE", `${fixed(metrics.depthMaeMm, 3)} mm`],
    ]),
  ];
}

function errorsSection(errors: PoseErrors | null, style: Style): string[] {
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
        `${fixed(1000 * translationErrorM, 2)} mm, ${fixed(100 * translationErrorRelative, 2)} % of the diameter`,
      ],
      ["ADD-S", `${fixed(addSMm, 2)} mm`],
    ]),
  ];
}

function layoutSection(layout: LayoutErrors | null, style: Style): string[] {
  if (layout === null) return [];
  const { boxIou, icpRotationDeg, addSRelative, isFound, isCadAligned } = layout;
  return [
    "",
    style.bold("Layout"),
    ...pairs([
      ["3D IoU", fixed(boxIou, 4)],
      ["ICP-Rot", `${fixed(icpRotationDeg, 2)}°`],
      ["ADD-S", `${fixed(100 * addSRelative, 2)} % of the diameter${isFound ? "" : ", not found"}`],
      ["20 cm, 20°, 20 %", isCadAligned ? "aligned" : "not aligned"],
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
      ? [style.red("failed ") + failureText(outcome)]
      : ("views" in outcome ? outcome.views : outcome.alignment).warnings.map(
          (warning) => `${outcome.name}: ${warningText(warning, style)}`,
        ),
  );
}
