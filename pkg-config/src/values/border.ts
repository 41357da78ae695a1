/**
 * The border: arguments are read once, before anything else looks at them. What is behind it are plain objects and arrays,
 * and typed arrays that have their memory.
 */

import { describe, failure, invalidArgument, messageOf, Sim3AlignError, withoutInput } from "./error.js";
import { isAttached, isBranded, isBuffer, isKind, isRecord, proxiedKind } from "./kinds.js";

/** No argument has more levels: a camera file of several images has five. Deeper objects are left out. */
const MAX_LEVELS = 8;

/** No array of numbers in an argument is longer; typed arrays are not copied. */
const MAX_LENGTH = 1 << 27;

/**
 * Copies the plain objects and arrays in an argument. Typed arrays, buffers, files, functions and prepared meshes remain
 * the same objects. An object inside itself is left out, so that what is read has an end.
 * @param argument its name in errors
 * @throws {@link Sim3AlignError} `INVALID_ARGUMENT` for properties that throw, proxies of typed arrays, and arrays and
 * buffers without their memory
 */
export function plainArgument<T>(argument: string, value: T): T {
  return copyOf(argument, value, MAX_LEVELS, new Map()) as T;
}

/**
 * Checks all typed arrays and buffers in an argument, which consists of plain objects and arrays. Detached memory must
 * neither reach the modules, which would trap, nor a worker of Node, which would get no message.
 * @param argument its name in errors
 * @throws {@link Sim3AlignError} `INVALID_ARGUMENT`
 */
export function checkAttached(argument: string, value: unknown): void {
  if (ArrayBuffer.isView(value) || isBuffer(value)) {
    if (!isAttached(value)) throw detached(argument, value);
  } else if (isRecord(value) || Array.isArray(value)) {
    for (const [name, inner] of Object.entries(value)) {
      if (typeof inner === "object")
        checkAttached(`${argument}${Array.isArray(value) ? `[${name}]` : `.${name}`}`, inner);
    }
  }
}

function detached(argument: string, value: unknown): Sim3AlignError {
  return failure(
    "INVALID_ARGUMENT",
    withoutInput(argument),
    `${describe(value).replace(/ of 0$/, "")} whose memory is detached: it was moved to another thread, or shrunk`,
    "an array with its memory",
    "After a call with transfer: true, use the arrays in `input` of the result or of the error.",
  );
}

/** @param copies those so far, as an object may be in two places; `undefined` for one that is being copied */
function copyOf(argument: string, value: unknown, levels: number, copies: Map<object, unknown>): unknown {
  if (typeof value !== "object" || value === null) return value;
  if (copies.has(value) || levels < 0) return copies.get(value);
  try {
    // Throws what a hostile proxy throws.
    Object.prototype.toString.call(value);
    const proxied = proxiedKind(value);
    if (proxied !== undefined) throw proxy(argument, value, proxied);
    if (ArrayBuffer.isView(value) || isBuffer(value)) {
      checkAttached(argument, value);
      return value;
    }
    const isImage = isKind(value, "ImageData") && argument.endsWith(".image");
    // Decoders are alive: their memory moves.
    if (
      isBranded(value, "PreparedMesh") ||
      argument.endsWith("Decoder") ||
      !(Array.isArray(value) || isRecord(value) || isImage)
    )
      return value;
    copies.set(value, undefined);
    const inner = (name: string, item: unknown) => copyOf(`${argument}${name}`, item, levels - 1, copies);
    const copy = Array.isArray(value)
      ? Array.from({ length: lengthOf(argument, value) }, (_, i) =>
          typeof value[i] === "object" ? inner(`[${i}]`, value[i]) : value[i],
        )
      : Object.fromEntries(namesOf(value).map((name) => [name, inner(`.${name}`, propertyOf(argument, value, name))]));
    copies.set(value, copy);
    return copy;
  } catch (cause) {
    throw cause instanceof Sim3AlignError ? cause : unreadable(argument, cause);
  }
}

/** The names of an object, and of the accessors of its class, as those of `ImageData`. */
function namesOf(value: object): string[] {
  const names = Object.keys(value);
  let prototype: object | null = Object.getPrototypeOf(value);
  for (let i = 0; i < MAX_LEVELS && prototype !== null; i++) {
    const next: object | null = Object.getPrototypeOf(prototype);
    // The last one is that of all objects.
    if (next === null) break;
    const properties = Object.entries(Object.getOwnPropertyDescriptors(prototype));
    names.push(...properties.filter(([, { get }]) => get !== undefined).map(([name]) => name));
    prototype = next;
  }
  return names;
}

function propertyOf(argument: string, value: object, name: string): unknown {
  try {
    return (value as Record<string, unknown>)[name];
  } catch (cause) {
    throw unreadable(`${argument}.${name}`, cause);
  }
}

function lengthOf(argument: string, array: readonly unknown[]): number {
  if (array.length <= MAX_LENGTH) return array.length;
  throw invalidArgument(withoutInput(argument), array, `at most ${MAX_LENGTH} values`, "Pass typed arrays.");
}

function proxy(argument: string, value: unknown, kind: string): Sim3AlignError {
  const remedy = "Pass the array itself: libraries that wrap objects can unwrap them.";
  return invalidArgument(withoutInput(argument), value, `${kind} that is no proxy`, remedy);
}

function unreadable(argument: string, cause: unknown): Sim3AlignError {
  const found = `a property that throws ${messageOf(cause)}`;
  const remedy = "It is a getter, or that of a proxy: see the cause.";
  return failure("INVALID_ARGUMENT", withoutInput(argument), found, "a property that can be read", remedy, cause);
}
