/** The error type of the package, and conversions to it. */
import type { ErrorCode as CoreErrorCode } from "../generated/types.js";
import { brand, proxiedKind, typedArrayKind } from "./kinds.js";

/**
 * Stable error code; does not change between releases. The troubleshooting guide describes the cause of each code, with
 * an example and a fix.
 */
export type ErrorCode =
  | CoreErrorCode
  /** A WebAssembly module could not be loaded. The next call tries again. */
  | "NOT_INITIALISED"
  /** The aligner has been disposed. Create another one. */
  | "DISPOSED"
  /** A worker could not be started, or terminated twice during the same call. Other calls continue with new workers. */
  | "WORKER_FAILED"
  /** A file of a case, or a file passed to the command line, does not exist. */
  | "FILE_NOT_FOUND";

/** The parts of a {@link Sim3AlignError}. */
export interface ErrorParts {
  code: ErrorCode;
  /** The invalid argument or option: `depth`, `mesh.indices`, `options.guard`. */
  argument: string;
  /** What was found. */
  found: string;
  /** What was expected. */
  expected: string;
  /** How to fix it. */
  remedy: string;
}

/**
 * The error that all functions of this package throw. The message states the argument, what was found, what was
 * expected, and the remedy; `code` is machine-readable. The aligner remains usable.
 */
export class Sim3AlignError extends Error implements ErrorParts {
  override readonly name = "Sim3AlignError";
  readonly code: ErrorCode;
  readonly argument: string;
  readonly found: string;
  readonly expected: string;
  readonly remedy: string;
  static {
    brand(Sim3AlignError, "Sim3AlignError");
  }

  /** With `transfer: true`: the input, if the worker could return it. */
  input?: unknown;

  /**
   * Creates an error whose message is made of its parts.
   * @param options may contain a `cause`
   */
  constructor({ code, argument, found, expected, remedy }: ErrorParts, options?: ErrorOptions) {
    super(`${argument}: found ${found}, expected ${expected}. ${remedy}`, options);
    this.code = code;
    this.argument = argument;
    this.found = found;
    this.expected = expected;
    this.remedy = remedy;
  }
}

/** Creates an error from its five parts and, if there is one, its cause. */
export const failure = (
  code: ErrorCode,
  argument: string,
  found: string,
  expected: string,
  remedy: string,
  cause?: unknown,
): Sim3AlignError =>
  new Sim3AlignError({ code, argument, found, expected, remedy }, cause === undefined ? undefined : { cause });

/** The error for an argument of the wrong type. */
export const invalidArgument = (argument: string, value: unknown, expected: string, remedy: string): Sim3AlignError =>
  failure("INVALID_ARGUMENT", argument, describe(value), expected, remedy);

/** Describes a value for error messages. */
export function describe(value: unknown): string {
  if (value === undefined) return "nothing";
  if (value === null) return "null";
  if (typeof value === "string") return `the string ${JSON.stringify(value.slice(0, 40))}`;
  if (typeof value === "function") return "a function";
  if (typeof value !== "object") return `${typeof value} ${String(value)}`;
  try {
    return describeObject(value);
  } catch {
    return "an object that throws when it is read";
  }
}

function describeObject(value: object): string {
  if (Array.isArray(value)) return `a plain array of ${value.length}`;
  const proxied = proxiedKind(value);
  if (proxied !== undefined) return `a proxy of ${proxied}`;
  const kind = typedArrayKind(value) ?? Object.prototype.toString.call(value).slice(8, -1);
  if (ArrayBuffer.isView(value)) {
    return typedArrayKind(value) === undefined ? kind : `${kind} of ${(value as Uint8Array).length}`;
  }
  if (kind !== "Object") return kind;
  const names = Object.keys(value);
  return names.length === 0 ? "an empty object" : `an object with ${names.slice(0, 8).join(", ")}`;
}

/** The message of anything that was thrown. */
export function messageOf(thrown: unknown): string {
  try {
    return thrown instanceof Error ? `${thrown.name}: ${thrown.message}` : String(thrown);
  } catch {
    return describe(thrown);
  }
}

/** Whether a module threw this error about its arguments: a plain object. Any other exception is a trap. */
export function isCoded(error: unknown): error is ErrorParts {
  if (typeof error !== "object" || error === null) return false;
  const parts: Partial<Record<keyof ErrorParts, unknown>> = error;
  return typeof parts.code === "string" && typeof parts.argument === "string" && typeof parts.remedy === "string";
}

/** Removes `input.` from the name of an argument: errors name the properties of the input. */
export const withoutInput = (argument: string) => argument.replace(/^input\./, "");

/**
 * Gives an error the stack of the call that it rejects. Its own one begins at a message of a worker, or at a timer.
 * @param call an error that was created where the call was made
 */
export function withStackOf(error: Sim3AlignError, { stack }: Error): Sim3AlignError {
  // Engines other than V8 write no message into a stack.
  if (typeof stack === "string") error.stack = stack.replace(/^Error(?=\n)/, () => `${error}`);
  return error;
}

/** The error for a trap inside WebAssembly, which no input should cause. */
export function internalError(cause: unknown): Sim3AlignError {
  const remedy = "This is a bug in sim3align: please report it with the input. The next call uses a new instance.";
  return failure("INTERNAL", "sim3align", messageOf(cause), "a result", remedy, cause);
}

/**
 * Whether an exception says that memory is exhausted: that of the allocator of the modules, which throws this before it
 * would trap, and those of the engines for arrays and instances.
 */
export function isExhausted(error: unknown): boolean {
  if (!(error instanceof Error)) return false;
  return error.message === EXHAUSTED || (error instanceof RangeError && /allocat|out of memory/i.test(error.message));
}

/** See `geometry/src/heap.rs`. */
const EXHAUSTED = "sim3align: memory exhausted";

/** The error for a call that needs more memory than there is. */
export function outOfMemory(cause: unknown): Sim3AlignError {
  const expected = "a call that fits in 4 GB, and in the memory of the machine";
  const remedy = "Crop the images to the object, reduce their size, or simplify the mesh; use fewer workers.";
  return failure("OUT_OF_MEMORY", "input", "more data than the memory can hold", expected, remedy, cause);
}

/** Whether a call failed because of its input, and not because of what runs it. */
export const isOfInput = (error: unknown): error is Sim3AlignError =>
  error instanceof Sim3AlignError && !["DISPOSED", "WORKER_FAILED", "INTERNAL", "NOT_INITIALISED"].includes(error.code);

/** The parts of an error, which can be sent to another thread. */
export function partsOf({ code, argument, found, expected, remedy }: Sim3AlignError): ErrorParts {
  return { code, argument, found, expected, remedy };
}

/** The same error with another name of its argument. */
export function renamed(error: Sim3AlignError, argument: string): Sim3AlignError {
  return new Sim3AlignError({ ...partsOf(error), argument }, { cause: error });
}

/** The error for calls on a disposed aligner. */
export function disposed(): Sim3AlignError {
  const remedy = "Create another one with createAligner().";
  return failure("DISPOSED", "aligner", "a disposed aligner", "an active aligner", remedy);
}
