/**
 * The border: arguments are read once, before anything else looks at them, because getters and proxies may throw, or return
 * something else the next time. What is behind it are plain objects and arrays, and typed arrays that have their memory.
 */
import { checkAttached } from "../attached.js";
import { failure, invalidArgument, messageOf, Sim3AlignError, withoutInput } from "../error.js";
import { isBuffer, isKind, isRecord, proxiedKind } from "../kinds.js";
import { PreparedMesh } from "../prepared-mesh.js";

/** No argument has more levels: a camera file of several images has five. Deeper objects are left out. */
const MAX_LEVELS = 8;

/** No array of numbers in an argument is longer; typed arrays are not copied. */
const MAX_LENGTH = 1 << 27;

/**
 * The names that may be read from the class of an object, by the argument that the object is (`[]` for any item of an array);
 * all, if missing.
 */
export type ClassNames = Readonly<Record<string, readonly string[]>>;

/**
 * Copies the plain objects and arrays in an argument. Typed arrays, buffers, files, functions and prepared meshes remain
 * the same objects. An object inside itself is left out, so that what is read has an end.
 * @param argument its name in errors
 * @throws {@link Sim3AlignError} `INVALID_ARGUMENT` for properties that throw, proxies of typed arrays, and arrays and
 * buffers without their memory
 */
export function ownArgument<T>(argument: string, value: T, classNames: ClassNames = {}): T {
  return new Reader(classNames).read(argument, value, 0) as T;
}

/** The options of a call, read once. */
export function ownOptions<T extends object>(options: T): T {
  if (isRecord(options)) return ownArgument("options", options as T);
  throw invalidArgument("options", options, "an object", "Pass { name: value }, or omit it.");
}

class Reader {
  readonly #classNames: ClassNames;
  /** The copies so far: an object may be in two places. */
  readonly #copies = new Map<object, object>();
  /** The objects that are being copied. */
  readonly #open = new Set<object>();

  constructor(classNames: ClassNames) {
    this.#classNames = classNames;
  }

  read(argument: string, value: unknown, level: number): unknown {
    if (typeof value !== "object" || value === null) return value;
    const copy = this.#copies.get(value);
    if (copy !== undefined) return copy;
    if (this.#open.has(value) || level > MAX_LEVELS) return undefined;
    try {
      const proxied = proxiedKind(value);
      if (proxied !== undefined) throw proxy(argument, value, proxied);
      if (ArrayBuffer.isView(value) || isBuffer(value)) {
        checkAttached(argument, value);
        return value;
      }
      if (value instanceof PreparedMesh || !(Array.isArray(value) || this.#isRead(argument, value))) return value;
      this.#open.add(value);
      const copied = Array.isArray(value) ? this.#array(argument, value, level) : this.#record(argument, value, level);
      this.#open.delete(value);
      this.#copies.set(value, copied);
      return copied;
    } catch (cause) {
      throw cause instanceof Sim3AlignError ? cause : unreadable(argument, cause);
    }
  }

  /** Whether an object is copied by its properties: also an object of the platform, if its names are known. */
  #isRead(argument: string, value: object): value is Record<string, unknown> {
    return isRecord(value) || (this.#knownNames(argument) !== undefined && isKind(value, "ImageData"));
  }

  #knownNames(argument: string): readonly string[] | undefined {
    return this.#classNames[argument.replace(/\[\d+\]/g, "[]")];
  }

  #array(argument: string, array: readonly unknown[], level: number): unknown[] {
    const { length } = array;
    if (!(length <= MAX_LENGTH)) {
      throw invalidArgument(withoutInput(argument), array, `at most ${MAX_LENGTH} values`, "Pass a typed array.");
    }
    const copy: unknown[] = [];
    for (let i = 0; i < length; i++) {
      const item = array[i];
      copy.push(typeof item === "object" ? this.read(`${argument}[${i}]`, item, level + 1) : item);
    }
    return copy;
  }

  #record(argument: string, record: Record<string, unknown>, level: number): object {
    const copy = {};
    for (const name of this.#namesOf(argument, record)) {
      let value: unknown;
      try {
        value = record[name];
      } catch (cause) {
        throw unreadable(`${argument}.${name}`, cause);
      }
      // Not an assignment, because of "__proto__".
      const own = { enumerable: true, configurable: true, writable: true };
      Object.defineProperty(copy, name, { ...own, value: this.read(`${argument}.${name}`, value, level + 1) });
    }
    return copy;
  }

  /** The names of an object, and of the accessors of its class. */
  #namesOf(argument: string, record: object): Iterable<string> {
    const names = new Set(Object.keys(record));
    const known = this.#knownNames(argument);
    let prototype: object | null = Object.getPrototypeOf(record);
    for (let i = 0; i < MAX_LEVELS && prototype !== null; i++) {
      const next: object | null = Object.getPrototypeOf(prototype);
      // The last one is that of all objects.
      if (next === null) break;
      for (const [name, { get, enumerable }] of Object.entries(Object.getOwnPropertyDescriptors(prototype))) {
        const isRead = get !== undefined || enumerable === true;
        if (isRead && (known === undefined || known.includes(name))) names.add(name);
      }
      prototype = next;
    }
    return names;
  }
}

function proxy(argument: string, value: unknown, kind: string): Sim3AlignError {
  const remedy = "Pass the array itself: libraries that wrap objects in proxies have a function that unwraps them.";
  return invalidArgument(withoutInput(argument), value, `${kind} that is no proxy`, remedy);
}

function unreadable(argument: string, cause: unknown): Sim3AlignError {
  const found = `a property that throws ${messageOf(cause)}`;
  const remedy = "The property is a getter or belongs to a proxy: see the cause of this error.";
  return failure("INVALID_ARGUMENT", withoutInput(argument), found, "a property that can be read", remedy, cause);
}
