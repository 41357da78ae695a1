/** What became of a case, for the table and for JSON. */
import { describe, Sim3AlignError } from "../error.js";
import type { Alignment, Evaluation, PoseErrors, Sim3 } from "../index.js";

/** A case that was aligned. */
export interface Success {
  name: string;
  alignment: Alignment;
  /** Against the case's truth, where it has one. */
  errors: PoseErrors | null;
}

/** A case that failed. */
export interface Failure {
  name: string;
  error: Sim3AlignError;
  /** The file at fault, where it is known. */
  file: string | undefined;
}

export type Outcome = Success | Failure;

/** Whatever was thrown, as the one error type. */
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

/** The failure of a case, some of whose files are known. */
export function failure(name: string, thrown: unknown, files: Readonly<Record<string, string>> = {}): Failure {
  const error = asSim3AlignError(thrown);
  return { name, error, file: files[error.argument.split(".")[0] ?? ""] };
}

/** A failure in a line or two. */
export function failureText({ name, error, file }: Failure): string {
  return `${name}: ${error.code}: ${error.message}${file === undefined ? "" : `\n  in ${file}`}`;
}

/** A transform and what belongs to it, in JSON. */
function transformJson<T extends Sim3>({ scale, rotation, rotationMatrix, translation, matrix, ...rest }: T) {
  return { scale, rotation: rotationMatrix, translation, matrix: Array.from(matrix), quaternion: rotation, ...rest };
}

/** The aligned case in JSON. */
function alignmentJson({ alignment, errors }: Success) {
  return {
    ...transformJson(alignment),
    alternatives: alignment.alternatives.map(transformJson),
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
