/** The one error type, and how what the WebAssembly modules throw becomes it. */
import type { ErrorCode as CoreErrorCode } from "./generated/types.js";

/**
 * What went wrong, as a name that stays the same from release to release. The guide on troubleshooting has a section for
 * each: cause, example and fix.
 */
export type ErrorCode =
  | CoreErrorCode
  /** A WebAssembly module could not be loaded. The next call tries again. */
  | "NOT_INITIALISED"
  /** The aligner was disposed of. Create a new one. */
  | "DISPOSED"
  /** A worker could not be started, or ended twice under the same call. Other calls go on, with new workers. */
  | "WORKER_FAILED"
  /** A file that the command line looked for is not there. */
  | "FILE_NOT_FOUND";

/** The parts of a {@link Sim3AlignError}. */
export interface ErrorParts {
  code: ErrorCode;
  /** The argument or option at fault: `depth`, `mesh.indices`, `options.guard`. */
  argument: string;
  /** What was found. */
  found: string;
  /** What was expected. */
  expected: string;
  /** What to do about it. */
  remedy: string;
}

/**
 * Every error of this package. The message says which argument is at fault, what was found, what was expected and
 * what to do; `code` is for programs. After it, the aligner that threw it works on.
 */
export class Sim3AlignError extends Error implements ErrorParts {
  override readonly name = "Sim3AlignError";
  readonly code: ErrorCode;
  readonly argument: string;
  readonly found: string;
  readonly expected: string;
  readonly remedy: string;
  /** With `transfer: true`: the input, handed back, where the worker could do so. */
  input?: unknown;

  /** The message is made of the parts; `options` may hold a `cause`. */
  constructor({ code, argument, found, expected, remedy }: ErrorParts, options?: ErrorOptions) {
    super(`${argument}: found ${found}, expected ${expected}. ${remedy}`, options);
    this.code = code;
    this.argument = argument;
    this.found = found;
    this.expected = expected;
    this.remedy = remedy;
  }
}

/** An error about an argument of the wrong kind. */
export function invalidArgument(argument: string, value: unknown, expected: string, remedy: string): Sim3AlignError {
  return new Sim3AlignError({ code: "INVALID_ARGUMENT", argument, found: describe(value), expected, remedy });
}

/** A value's kind, for people. */
export function describe(value: unknown): string {
  if (value === undefined) return "nothing";
  if (value === null) return "null";
  if (Array.isArray(value)) return `a plain array of ${value.length}`;
  if (typeof value === "string") return `the string ${JSON.stringify(value.slice(0, 40))}`;
  if (typeof value !== "object") return typeof value === "function" ? "a function" : `${typeof value} ${String(value)}`;
  const kind = Object.prototype.toString.call(value).slice(8, -1);
  const { length } = value as { length?: unknown };
  if (ArrayBuffer.isView(value)) return typeof length === "number" ? `${kind} of ${length}` : kind;
  if (kind !== "Object") return kind;
  const names = Object.keys(value);
  return names.length === 0 ? "an empty object" : `an object with ${names.slice(0, 8).join(", ")}`;
}

/** Whether a module threw this about its caller's input; anything else that it throws is a trap. */
export function isCoded(error: unknown): error is Error & ErrorParts {
  return error instanceof Error && error.name === "Sim3AlignError" && "code" in error;
}

/** A trap inside WebAssembly, which no input should be able to cause. */
export function internalError(cause: unknown): Sim3AlignError {
  return new Sim3AlignError(
    {
      code: "INTERNAL",
      argument: "sim3align",
      found: cause instanceof Error ? `${cause.name}: ${cause.message}` : String(cause),
      expected: "a result",
      remedy: "This is a fault of the package: please report it with the input. The next call starts afresh.",
    },
    { cause },
  );
}

/** The parts alone, which go from one thread to another. */
export function partsOf({ code, argument, found, expected, remedy }: Sim3AlignError): ErrorParts {
  return { code, argument, found, expected, remedy };
}

/** What calls of an aligner get that is no more. */
export function disposed(): Sim3AlignError {
  return new Sim3AlignError({
    code: "DISPOSED",
    argument: "aligner",
    found: "an aligner that was disposed of",
    expected: "one in use",
    remedy: "Create a new one with createAligner(), or dispose of it later.",
  });
}
