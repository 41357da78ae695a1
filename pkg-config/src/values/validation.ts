/** Validation of arguments, with errors that name them. Values may come from any realm: window, worker, test runner. */
import { plainArgument } from "./border.js";
import { describe, failure, invalidArgument, type Sim3AlignError } from "./error.js";
import { isKind, isRecord, typedArrayKind } from "./kinds.js";

/** The error for a plain array, or a typed array of the wrong type. */
export function wrongKind(argument: string, value: unknown, expected: string, typedArray: string): Sim3AlignError {
  const isArray = isKind(value, "Array") || (ArrayBuffer.isView(value) && !isKind(value, "DataView"));
  const remedy = isArray ? `Convert it: ${typedArray}.from(${argument}).` : "Pass one of these.";
  return invalidArgument(argument, value, expected, remedy);
}

/** Copies an object without its undefined properties. */
export function withoutUndefined<T extends object>(object: T): { [K in keyof T]?: Exclude<T[K], undefined> } {
  const entries = Object.entries(object).filter(([, value]) => value !== undefined);
  return Object.fromEntries(entries) as { [K in keyof T]?: Exclude<T[K], undefined> };
}

/** A function that makes something once for each key. */
export function oncePerKey<K, T, A extends unknown[]>(make: (key: K, ...more: A) => T): (key: K, ...more: A) => T {
  const made = new Map<K, T>();
  return (key, ...more) => {
    if (!made.has(key)) made.set(key, make(key, ...more));
    return made.get(key) as T;
  };
}

/** The strings in an array; none for any other value. */
export const stringsIn = (value: unknown): string[] =>
  Array.isArray(value) ? value.filter((text) => typeof text === "string") : [];

/**
 * Rejects misspelt properties, which would otherwise be ignored.
 * @param prefix of their names in errors
 * @throws {@link Sim3AlignError} with the code
 */
export function checkNames(
  prefix: string,
  object: object,
  names: readonly string[],
  remedy: string,
  code: "INVALID_ARGUMENT" | "UNKNOWN_OPTION" = "INVALID_ARGUMENT",
): void {
  const unknown = Object.keys(object).find((name) => !names.includes(name));
  if (unknown !== undefined) throw failure(code, prefix + unknown, "an unknown property", names.join(", "), remedy);
}

/** Three numbers: x, y, z. */
export type Vector3 = [x: number, y: number, z: number];

/** A unit quaternion, x, y, z, w: the order of three.js, glTF and ROS. */
export type Quaternion = [x: number, y: number, z: number, w: number];

/** Maximum depth of nested arrays: a tensor has few levels, and an array may contain itself. */
const MAX_NESTING = 16;

function flat(array: readonly unknown[], levels: number): unknown[] {
  if (levels === 0) throw new Error("too many levels");
  // Calls the array's own `slice`: a proxy that invents a value for every property has no such function, so this throws
  // instead of looping over an invented length. `Array.from` turns holes into undefined.
  const copy = Array.from(array.slice());
  if (!copy.some(Array.isArray)) return copy;
  return copy.flatMap((item) => (Array.isArray(item) ? flat(item, levels - 1) : [item]));
}

/** Flattens an array of any type and nesting, such as `[[1, 2]]` or the data of a tensor; `null` for anything else. */
export function flattened(value: unknown): unknown[] | null {
  try {
    if (Array.isArray(value)) return flat(value, MAX_NESTING);
    if (typedArrayKind(value) !== undefined) return Array.from(value as ArrayLike<unknown>);
  } catch {
    // Memory that is not there, a proxy that throws, or an array within itself.
  }
  return null;
}

/** `count` finite numbers, from an array of any type and nesting. */
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

/** An integer of at least `least`. */
export function whole(argument: string, value: unknown, least: number): number {
  if (Number.isSafeInteger(value) && (value as number) >= least) return value as number;
  const remedy = "Pass a number of pixels.";
  throw failure("INVALID_ARGUMENT", argument, describe(value), `an integer of at least ${least}`, remedy);
}

/** A text, such as a name. */
export function text(argument: string, value: unknown): string {
  if (typeof value === "string") return value;
  throw failure("INVALID_ARGUMENT", argument, describe(value), "a string", "Pass a text.");
}

/** One of several names. */
export function oneOf<T extends string>(
  argument: string,
  value: unknown,
  words: readonly T[],
  code: "INVALID_ARGUMENT" | "INVALID_OPTION" = "INVALID_OPTION",
): T {
  if (words.includes(value as T)) return value as T;
  const expected = words.map((word) => JSON.stringify(word)).join(" or ");
  throw failure(code, argument, describe(value), expected, "Check the spelling.");
}

/**
 * The options of a call, read once.
 * @throws {@link Sim3AlignError} `UNKNOWN_OPTION` for a name that is not among these, which would otherwise be ignored
 */
export function optionsOf<T extends object>(options: T, names: readonly (keyof T & string)[]): T {
  return withoutUndefined(knownOptions(record("options", options, OPTIONS) as T, names)) as T;
}

/** Options that contain live objects, such as decoders: checked like those of {@link optionsOf}, but not copied. */
export function knownOptions<T extends object>(options: T, names: readonly (keyof T & string)[]): T {
  checkNames("options.", part("options", options, OPTIONS), names, "Check the spelling.", "UNKNOWN_OPTION");
  return options;
}

const OPTIONS = "an object with options";

/** An object with properties, read once: no getter of it runs later. */
export const record = (argument: string, value: unknown, expected: string): Record<string, unknown> =>
  plainArgument(argument, part(argument, value, expected));

/** An object with properties that has been read: a part of an argument, or an argument behind the border. */
export function part(argument: string, value: unknown, expected: string): Record<string, unknown> {
  if (isRecord(value)) return value;
  throw failure("INVALID_ARGUMENT", argument, describe(value), expected, "Pass an object with these properties.");
}
