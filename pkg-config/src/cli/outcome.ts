/** Outcomes of cases, for tables and for JSON. */
import { describe, Sim3AlignError } from "../error.js";
import type { AlignResult, Evaluation, PoseErrors, Sim3 } from "../index.js";

/** An aligned case. */
export interface Success {
  name: string;
  alignment: AlignResult;
  /** The errors relative to the true pose, if the case has one. */
  errors: PoseErrors | null;
}

/** A failed case. */
export interface Failure {
  name: string;
  error: Sim3AlignError;
  /** The invalid file, if known. */
  file: string | undefined;
}

export type Outcome = Success | Failure;

/** Converts any exception to a `Sim3AlignError`. */
export function asSim3AlignError(error: unknown): Sim3AlignError {
  if (error instanceof Sim3AlignError) return error;
  return new Sim3AlignError(
    {
      code: "INTERNAL",
      argument: "sim3align",
      found: error instanceof Error ? (error.stack ?? error.message) : describe(error),
      expected: "a result or a Sim3AlignError",
      remedy: "This is a bug in sim3align. Please report it with the input.",
    },
    { cause: error },
  );
}

/** The failure of a case. `files` maps arguments to the known files. */
export function failure(name: string, thrown: unknown, files: Readonly<Record<string, string>> = {}): Failure {
  const error = asSim3AlignError(thrown);
  return { name, error, file: files[error.argument.split(".")[0] ?? ""] };
}

/** Formats a failure in one or two lines. */
export function failureText({ name, error, file }: Failure): string {
  return `${name}: ${error.code}: ${error.message}${file === undefined ? "" : `\n  in ${file}`}`;
}

/** The transform and other common properties of a JSON entry. */
function transformJson<T extends Sim3>({ scale, rotation, rotationMatrix, translation, matrix, ...rest }: T) {
  return { scale, rotation: rotationMatrix, translation, matrix, quaternion: rotation, ...rest };
}

/** The JSON entry of an aligned case. The keys do not depend on the preset. */
function alignmentJson({ alignment, errors }: Success) {
  const { scale, rotation, rotationMatrix, translation, matrix, metrics, warnings } = alignment;
  const { timingsMs, ...diagnostics } = alignment.diagnostics;
  const { confidence, alternatives, uncertainty } =
    "confidence" in alignment ? alignment : { confidence: null, alternatives: [], uncertainty: null };
  return {
    ...transformJson({ scale, rotation, rotationMatrix, translation, matrix }),
    confidence,
    alternatives: alternatives.map(transformJson),
    uncertainty,
    ...(metrics === undefined ? {} : { metrics }),
    warnings,
    timingsMs,
    diagnostics,
    ...(errors === null ? {} : { errors }),
  };
}

function failureJson({ error, file }: Failure) {
  const { code, argument, found, expected, remedy, message } = error;
  return { error: { code, argument, found, expected, remedy, message, ...(file === undefined ? {} : { file }) } };
}

/** The JSON entry of a case. */
export const outcomeJson = (outcome: Outcome): object =>
  "error" in outcome ? failureJson(outcome) : alignmentJson(outcome);

/** The JSON entry of an evaluated case. */
export const evaluationJson = (evaluation: Evaluation | Failure): object =>
  "error" in evaluation ? failureJson(evaluation) : evaluation;
