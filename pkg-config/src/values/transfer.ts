/** Copies or lists the arrays that are sent to a worker. */
import { isBuffer, isKind, isRecord, typedArrayKind } from "./kinds.js";

type View = new (buffer: ArrayBuffer) => ArrayBufferView;

/** Copies the typed arrays and buffers in a value, each into a separate buffer; traverses plain objects. */
export function copied<T>(value: T): T {
  const copy = mapped(value, (array) => {
    if (!ArrayBuffer.isView(array)) return array.slice(0);
    const Kind = (globalThis as unknown as Record<string, View>)[typedArrayKind(array) ?? "DataView"] as View;
    return new Kind(new Uint8Array(array.buffer, array.byteOffset, array.byteLength).slice().buffer);
  });
  return copy as T;
}

/**
 * Whether a worker receives the value as it is. Others cannot be sent, or arrive as something else, which would change
 * the error.
 */
export function isSendable(value: unknown): boolean {
  if (Object(value) !== value) return typeof value !== "symbol";
  if (ArrayBuffer.isView(value) || isBuffer(value) || isKind<SharedArrayBuffer>(value, "SharedArrayBuffer"))
    return true;
  if (isKind<Blob>(value, "Blob", "File")) return typeof value.arrayBuffer === "function";
  return Array.isArray(value) ? value.every(isSendable) : isRecord(value) && Object.values(value).every(isSendable);
}

/** A value without the parts that are not {@link isSendable}. */
export function sendableParts<T>(value: T): T;
export function sendableParts(value: unknown): unknown {
  if (isSendable(value)) return value;
  if (Array.isArray(value)) return value.map(sendableParts);
  if (isRecord(value)) return Object.fromEntries(Object.entries(value).map(([k, inner]) => [k, sendableParts(inner)]));
  return undefined;
}

/** The distinct buffers of the arrays in a value. */
export function buffersOf(value: unknown): ArrayBuffer[] {
  const buffers = new Set<ArrayBuffer>();
  mapped(value, (array) => {
    const buffer = ArrayBuffer.isView(array) ? array.buffer : array;
    // Shared memory cannot be transferred.
    if (isBuffer(buffer)) buffers.add(buffer);
    return array;
  });
  return [...buffers];
}

function mapped(value: unknown, replace: (array: ArrayBuffer | ArrayBufferView) => unknown): unknown {
  if (ArrayBuffer.isView(value) || isBuffer(value)) return replace(value);
  if (Array.isArray(value)) return value.map((inner) => mapped(inner, replace));
  if (!isRecord(value)) return value;
  return Object.fromEntries(Object.entries(value).map(([name, inner]) => [name, mapped(inner, replace)]));
}
