/** Outcomes of cases, for tables and for JSON. */

import type { AlignResult, Evaluation, InputInfo, PoseErrors, Sim3, TrackedFrame, ViewsAlignment } from "../index.js";
import { describe, failure, Sim3AlignError } from "../values/error.js";
import { withoutUndefined } from "../values/values.js";
import type { Lengths } from "./lengths.js";
import type { Style } from "./style.js";
import { UsageError } from "./usage-error.js";

/** An aligned case. */
export interface Success {
  name: string;
  alignment: AlignResult;
  /** The errors relative to the true pose, if the case has one. */
  errors: PoseErrors | null;
}

/** A case of several views that was aligned. */
export interface ViewsSuccess {
  name: string;
  views: ViewsAlignment;
  /** The names of the views, in order. */
  frames: readonly string[];
  /** The errors relative to the true pose of each view, if it has one. */
  errors: readonly (PoseErrors | null)[];
}

/** A failed case. */
export interface Failure {
  name: string;
  error: Sim3AlignError;
  /** The invalid file, if known. */
  file: string | undefined;
}

export type Outcome = Success | ViewsSuccess | Failure;

/** Converts any exception to a `Sim3AlignError`. */
function asSim3AlignError(error: unknown): Sim3AlignError {
  if (error instanceof Sim3AlignError) return error;
  const found = error instanceof Error ? (error.stack ?? error.message) : describe(error);
  const remedy = "This is a bug in sim3align. Please report it with the input.";
  return failure("INTERNAL", "sim3align", found, "a result or a Sim3AlignError", remedy, error);
}

/**
 * The failure of a case. `files` maps arguments to the known files.
 * @throws {@link UsageError} for what concerns all cases
 */
export function failureOf(name: string, thrown: unknown, files: Readonly<Record<string, string>> = {}): Failure {
  if (thrown instanceof UsageError) throw thrown;
  const error = asSim3AlignError(thrown);
  if (isAboutOptions(error)) throw new UsageError(error.message);
  return { name, error, file: files[error.argument.split(".")[0] ?? ""] };
}

/** Whether all cases would fail with this error. The initial pose may differ from case to case. */
const isAboutOptions = ({ argument }: Sim3AlignError) =>
  argument.startsWith("options") && !argument.startsWith("options.initial");

/** Formats a failure in one or two lines. */
export function failureText({ name, error, file }: Failure): string {
  return `${name}: ${error.code}: ${error.message}${file === undefined ? "" : `\n  in ${file}`}`;
}

/** What is printed of a failure. */
export const failedLine = (failure: Failure, style: Style): string => style.red("failed ") + failureText(failure);

/** The transform and other common properties of a JSON entry. */
function transformJson<T extends Sim3>({ scale, rotation, rotationMatrix, translation, matrix, ...rest }: T) {
  return { scale, rotation: rotationMatrix, translation, matrix, quaternion: rotation, ...rest };
}

/** How depth and camera were read. */
export const ofInputJson = ({ depthUnit, cameraSource, depthCalibration }: InputInfo) =>
  withoutUndefined({ depthUnit, cameraSource, depthCalibration });

/** The JSON entry of an aligned case. The keys do not depend on the preset. */
function alignmentJson({ alignment, errors }: Success) {
  const { scale, rotation, rotationMatrix, translation, matrix, metrics, warnings } = alignment;
  const { timingsMs, ...diagnostics } = alignment.diagnostics;
  const { confidence, turnConfidence, alternatives, uncertainty, proportions } =
    "confidence" in alignment
      ? alignment
      : { confidence: null, turnConfidence: null, alternatives: [], uncertainty: null };
  return {
    ...transformJson({ scale, rotation, rotationMatrix, translation, matrix }),
    confidence,
    turnConfidence,
    alternatives: alternatives.map(transformJson),
    uncertainty,
    ...(proportions === undefined ? {} : { proportions: transformJson(proportions) }),
    ...(metrics === undefined ? {} : { metrics }),
    warnings,
    ...ofInputJson(alignment),
    timingsMs,
    diagnostics,
    ...(errors === null ? {} : { errors }),
  };
}

/** The JSON entry of several views: the pose in the world, if the camera poses are known, and in each frame. */
function viewsJson({ views: alignment, frames, errors }: ViewsSuccess) {
  const { scale, rotation, rotationMatrix, translation, matrix, world, alternatives, views } = alignment;
  const { confidence, uncertainty, proportions, warnings } = alignment;
  const { timingsMs, ...diagnostics } = alignment.diagnostics;
  const pose = transformJson({ scale, rotation, rotationMatrix, translation, matrix });
  const frame = (k: number) => {
    const { camera, ...view } = views[k] as (typeof views)[number];
    const own = errors[k] ?? null;
    return { ...transformJson(view), camera: transformJson(camera), ...(own === null ? {} : { errors: own }) };
  };
  return {
    // Without camera poses, there is no world: the poses are those of the frames.
    ...(world === "given" ? pose : { scale }),
    world,
    confidence,
    alternatives: alternatives.map(transformJson),
    uncertainty,
    ...(proportions === undefined ? {} : { proportions: transformJson(proportions) }),
    frames: Object.fromEntries(frames.map((name, k) => [name, frame(k)])),
    warnings,
    timingsMs,
    diagnostics,
  };
}

/** The JSON entry of a video, with the frames so far. */
export function trackJson(frames: readonly { name: string; tracked: TrackedFrame | Failure }[]): object {
  const poses = frames.flatMap(({ tracked }) => ("error" in tracked ? [] : [tracked]));
  const entry = ({ tracked }: (typeof frames)[number]) =>
    "error" in tracked ? failureJson(tracked) : transformJson(tracked);
  return {
    scale: poses.at(-1)?.scale ?? null,
    frames: Object.fromEntries(frames.map((frame) => [frame.name, entry(frame)])),
  };
}

function failureJson({ error, file }: Failure) {
  const { code, argument, found, expected, remedy, message } = error;
  return { error: { code, argument, found, expected, remedy, message, ...(file === undefined ? {} : { file }) } };
}

/** The JSON entry of a case. */
export const outcomeJson = (outcome: Outcome): object =>
  "error" in outcome ? failureJson(outcome) : "views" in outcome ? viewsJson(outcome) : alignmentJson(outcome);

/** The JSON entry of an evaluated case. */
export const evaluationJson = (evaluation: Evaluation | Failure, { isMetric }: Lengths): object =>
  "error" in evaluation ? failureJson(evaluation) : isMetric ? evaluation : { ...evaluation, isMetric };
