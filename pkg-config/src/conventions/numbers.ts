/** Checks of plain numbers and lists of them, with errors that name the argument. */
import { describe, type ErrorCode, Sim3AlignError } from "../error.js";
import { isRecord } from "../values.js";

/** Three numbers: x, y, z. */
export type Vector3 = [x: number, y: number, z: number];

/** A unit quaternion, x, y, z, w: the order of three.js, glTF and ROS. */
export type Quaternion = [x: number, y: number, z: number, w: number];

/** Shorthand for the errors of this folder. */
export function failure(
  code: ErrorCode,
  argument: string,
  found: string,
  expected: string,
  remedy: string,
): Sim3AlignError {
  return new Sim3AlignError({ code, argument, found, expected, remedy });
}

/** All elements of an array, of whatever kind and nesting: `[[1, 2]]` and a tensor's data alike. */
export function flattened(value: unknown): unknown[] | null {
  if (Array.isArray(value)) return value.flat(Number.POSITIVE_INFINITY);
  if (ArrayBuffer.isView(value) && "length" in value) return Array.from(value as unknown as ArrayLike<unknown>);
  return null;
}

/** That many finite numbers, from an array of any kind and nesting. */
export function finiteNumbers(argument: string, value: unknown, count: number, expected: string): number[] {
  const remedy = "Pass an array or a typed array with these numbers.";
  const numbers = flattened(value);
  if (numbers === null) throw failure("INVALID_ARGUMENT", argument, describe(value), expected, remedy);
  if (numbers.length !== count) {
    throw failure("WRONG_LENGTH", argument, `${numbers.length} numbers`, expected, remedy);
  }
  const wrong = numbers.find((number) => !Number.isFinite(number));
  if (wrong !== undefined) throw failure("NON_FINITE", argument, describe(wrong), expected, "Pass finite numbers.");
  return numbers as number[];
}

/** Three finite numbers. */
export const vector3 = (argument: string, value: unknown) =>
  finiteNumbers(argument, value, 3, "three finite numbers") as Vector3;

/** A finite number. */
export function finite(argument: string, value: unknown): number {
  if (typeof value === "number" && Number.isFinite(value)) return value;
  throw failure("INVALID_ARGUMENT", argument, describe(value), "a finite number", "Pass a number.");
}

/** A finite number above 0. */
export function positive(argument: string, value: unknown): number {
  if (typeof value === "number" && Number.isFinite(value) && value > 0) return value;
  throw failure("INVALID_ARGUMENT", argument, describe(value), "a finite number above 0", "Check the unit.");
}

/** A whole number from `least` on. */
export function whole(argument: string, value: unknown, least: number): number {
  if (Number.isSafeInteger(value) && (value as number) >= least) return value as number;
  throw failure(
    "INVALID_ARGUMENT",
    argument,
    describe(value),
    `a whole number from ${least} on`,
    "Pass a number of pixels.",
  );
}

/** One of several words. */
export function oneOf<T extends string>(argument: string, value: unknown, words: readonly T[]): T {
  if (words.includes(value as T)) return value as T;
  const expected = words.map((word) => JSON.stringify(word)).join(" or ");
  throw failure("INVALID_OPTION", argument, describe(value), expected, "Check the spelling.");
}

/** An object with properties. */
export function record(argument: string, value: unknown, expected: string): Record<string, unknown> {
  if (isRecord(value)) return value;
  throw failure("INVALID_ARGUMENT", argument, describe(value), expected, "Pass an object with these properties.");
}
