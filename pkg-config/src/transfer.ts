/** Arrays on their way to a worker: copied, or moved. */

type TypedArray = Uint8Array | Uint8ClampedArray | Uint16Array | Uint32Array | Float32Array | Float64Array;

const kinds = new Map<string, new (buffer: ArrayBuffer) => TypedArray>(
  [Uint8Array, Uint8ClampedArray, Uint16Array, Uint32Array, Float32Array, Float64Array].map((kind) => [
    kind.name,
    kind,
  ]),
);

/** The value with its typed arrays and buffers copied, each into a buffer of its own; plain objects are followed. */
export function copied<T>(value: T): T {
  return mapped(value, (array) => {
    if (array instanceof ArrayBuffer) return array.slice(0);
    const Kind = kinds.get(kindOf(array));
    if (Kind === undefined) return array;
    const bytes = new Uint8Array(array.byteLength);
    // An array whose buffer was given away has no bytes, and can't be looked into.
    if (array.byteLength > 0) bytes.set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
    return new Kind(bytes.buffer);
  }) as T;
}

/** The buffers behind a value's arrays, each once. */
export function buffersOf(value: unknown): ArrayBuffer[] {
  const buffers = new Set<ArrayBuffer>();
  mapped(value, (array) => {
    const buffer = array instanceof ArrayBuffer ? array : array.buffer;
    if (buffer instanceof ArrayBuffer) buffers.add(buffer);
    return array;
  });
  return [...buffers];
}

function mapped(value: unknown, replace: (array: ArrayBuffer | ArrayBufferView) => unknown): unknown {
  if (value instanceof ArrayBuffer || ArrayBuffer.isView(value)) return replace(value);
  if (kindOf(value) !== "Object") return value;
  const entries = Object.entries(value as object).map(([name, inner]) => [name, mapped(inner, replace)]);
  return Object.fromEntries(entries);
}

const kindOf = (value: unknown) => Object.prototype.toString.call(value).slice(8, -1);
