/**
 * What kind of built-in object a value is. Values may come from any realm: window, worker, test runner. Nothing here
 * throws, whatever the value is.
 */

/** The name of a built-in type, such as "Blob"; empty for objects that throw when they are asked. */
function tagOf(value: unknown): string {
  try {
    return Object.prototype.toString.call(value).slice(8, -1);
  } catch {
    return "";
  }
}

/** Whether the value is of one of these built-in types. A proxy may claim to be of one: see {@link isTypedArray}. */
export function isKind<T>(value: unknown, ...names: string[]): value is T {
  return names.includes(tagOf(value));
}

/** Whether the value is an object other than an array, a buffer or a file. */
export function isRecord(value: unknown): value is Record<string, unknown> {
  return isKind(value, "Object");
}

const typedArrayPrototype = Object.getPrototypeOf(Uint8Array.prototype);

/** The type of a typed array; `undefined` for all other values, also for proxies of typed arrays. */
export function typedArrayKind(value: unknown): string | undefined {
  // Unlike the tag, this can neither be overridden nor forwarded by a proxy.
  return Object.getOwnPropertyDescriptor(typedArrayPrototype, Symbol.toStringTag)?.get?.call(value);
}

/** Whether the value is a typed array of one of these types. */
export function isTypedArray<T>(value: unknown, ...names: string[]): value is T {
  return names.includes(typedArrayKind(value) ?? "");
}

/** Whether the value is an `ArrayBuffer`, and not a proxy of one. */
export function isBuffer(value: unknown): value is ArrayBuffer {
  try {
    Object.getOwnPropertyDescriptor(ArrayBuffer.prototype, "byteLength")?.get?.call(value);
    return true;
  } catch {
    return false;
  }
}

/** The built-in type that a proxy stands for, if it can be told. */
export function proxiedKind(value: unknown): string | undefined {
  const tag = tagOf(value);
  if (/(^(Shared)?Array|^Data|[a-z\d]Array$)/.test(tag) && tag !== "Array") {
    const isReal = ArrayBuffer.isView(value) || isBuffer(value) || tag === "SharedArrayBuffer";
    return isReal ? undefined : tag;
  }
  if (ArrayBuffer.isView(value) || !isInstance(value, typedArrayPrototype.constructor)) return undefined;
  let name: unknown;
  try {
    name = (value as object).constructor.name;
  } catch {
    // Its proxy throws.
  }
  return typeof name === "string" ? name : "typed array";
}

function isInstance(value: unknown, type: new () => unknown): boolean {
  try {
    return value instanceof type;
  } catch {
    return false;
  }
}

/** Whether the memory of a typed array or a buffer is there: not detached, and not shrunk below the array. */
export function isAttached(value: ArrayBufferView | ArrayBuffer): boolean {
  try {
    // Both throw for memory that is not there, and copy nothing.
    if (ArrayBuffer.isView(value)) typedArrayKind(value) === undefined ? value.byteLength : keysOf.call(value);
    else new Uint8Array(value);
    return true;
  } catch {
    return false;
  }
}

const keysOf: () => unknown = typedArrayPrototype.keys;

/** A key of classes that copies of the package share: an app may load `sim3align/inline` beside the other entries. */
const brandOf = (name: string) => Symbol.for(`sim3align.${name}`);

/** Whether an object is of the class with this name, of any copy of the package. Throws what a proxy throws. */
export const isBranded = (value: unknown, name: string): boolean =>
  Object(value) === value && brandOf(name) in (value as object);

/** Makes `instanceof` of a class accept the objects of every copy of the package. Classes that extend it keep their own. */
export function brand(type: abstract new (...args: never[]) => object, name: string): void {
  Object.defineProperty(type.prototype, brandOf(name), { value: true });
  Object.defineProperty(type, Symbol.hasInstance, {
    value(this: unknown, value: unknown): boolean {
      const isOfThis = () => Object.prototype.isPrototypeOf.call((this as typeof type).prototype, value as object);
      return isBranded(value, name) && (this === type || isOfThis());
    },
  });
}
