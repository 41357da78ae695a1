/** The outcome of a case, for the table and for JSON. */
import { describe, Sim3AlignError } from "../error.js";
import type { AlignResult, Evaluation, PoseErrors, Sim3 } from "../index.js";

/** A case that was aligned. */
export interface Success {
  name: string;
  alignment: AlignResult;
  /** The errors against the case's truth, if it has one. */
  errors: PoseErrors | null;
}

/** A case that failed. */
export interface Failure {
  name: string;
  error: Sim3AlignError;
  /** The file at fault, if known. */
  file: string | undefined;
}

export type Outcome = Success | Failure;

/** Any exception as a `Sim3AlignError`. */
export function asSim3AlignError(error: unknown): Sim3AlignError {
  if (error instanceof Sim3AlignError) return error;
  return new Sim3AlignError(
    {
      code: "INTERNAL",
      argument: "sim3align",
      found: error instanceof Error ? (error.stack ?? error.message) : describe(error),
      expected: "no such fault",
      remedy: "This is a fault of the package: please report it with the input.",
    },
    { cause: error },
  );
}

/** The failure of a case; `files` are its files by argument, as far as they are known. */
export function failure(name: string, thrown: unknown, files: Readonly<Record<string, string>> = {}): Failure {
  const error = asSim3AlignError(thrown);
  return { name, error, file: files[error.argument.split(".")[0] ?? ""] };
}

/** A failure in a line or two. */
export function failureText({ name, error, file }: Failure): string {
  return `${name}: ${error.code}: ${error.message}${file === undefined ? "" : `\n  in ${file}`}`;
}

/** A transform and its other properties in JSON. */
function transformJson<T extends Sim3>({ scale, rotation, rotationMatrix, translation, matrix, ...rest }: T) {
  return { scale, rotation: rotationMatrix, translation, matrix, quaternion: rotation, ...rest };
}

/** The aligned case in JSON. All cases have the same keys, whatever the preset. */
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

/** All cases in JSON, by name. */
export function outcomesJson(outcomes: readonly Outcome[]): string {
  const entries = outcomes.map((outcome) => [
    outcome.name,
    "error" in outcome ? failureJson(outcome) : alignmentJson(outcome),
  ]);
  return `${JSON.stringify(Object.fromEntries(entries), null, 2)}\n`;
}

/** An evaluated case in JSON. */
export function evaluationJson(name: string, evaluation: Evaluation | Failure): string {
  const entry = "error" in evaluation ? failureJson(evaluation) : evaluation;
  return `${JSON.stringify({ [name]: entry }, null, 2)}\n`;
}
