/** Values of every kind that a caller without types may pass, from a seed. */
import type { Random } from "../random.js";

/** What getters, proxies and callbacks of the fuzzer throw. */
export class Thrown extends Error {
  override readonly name = "Thrown";
}

/** One of several things. */
export const pick = <T>(random: Random, items: readonly T[]): T => items[random.whole(0, items.length - 1)] as T;

const fail = (): never => {
  throw new Thrown("thrown by the fuzzer");
};

const numbers = [0, -0, -1, 1, 0.5, 3, 160, 2 ** 31, 2 ** 53, 1e12, -1e-12, Number.NaN, Number.POSITIVE_INFINITY];
const texts = ["", "160", "best", "NaN", "\u{1f9ca}", "\ud800", "__proto__", "{", '{"fx":1}', "x".repeat(5000)];

class WithAccessors {
  get width() {
    return 16;
  }
  get throws() {
    return fail();
  }
}

/** Makes an array on memory of a kind. */
type Memory = (bytes: number) => ArrayBuffer;
const Resizable = ArrayBuffer as unknown as new (
  length: number,
  options: { maxByteLength: number },
) => ArrayBuffer & { resize(length: number): void };

const memories: Memory[] = [
  (bytes) => new ArrayBuffer(bytes),
  (bytes) => new SharedArrayBuffer(bytes) as unknown as ArrayBuffer,
  (bytes) => new Resizable(bytes, { maxByteLength: bytes + 64 }),
  () => new WebAssembly.Memory({ initial: 1 }).buffer,
];

const kinds = [
  ...[Float32Array, Float64Array, Uint8Array, Uint8ClampedArray, Uint16Array, Uint32Array, Int8Array, Int32Array],
  ...[BigInt64Array, BigUint64Array],
];

/** Detaches the memory of an array or a buffer. */
export function detach(value: ArrayBufferView | ArrayBuffer): void {
  const buffer = ArrayBuffer.isView(value) ? value.buffer : value;
  try {
    structuredClone(buffer, { transfer: [buffer as ArrayBuffer] });
  } catch {
    // Shared memory and that of WebAssembly cannot be detached.
  }
}

/** A typed array of any kind, on memory of any kind, possibly detached or shrunk. */
export function oddArray(random: Random): ArrayBufferView {
  const Kind = pick(random, kinds);
  const length = pick(random, [0, 1, 3, 9, 16, 192]);
  const buffer = pick(random, memories)(8 * length);
  const array = new Kind(buffer, 0, random.between(0, 1) < 0.5 ? length : undefined);
  if (random.between(0, 1) < 0.2) detach(array);
  if (random.between(0, 1) < 0.2 && "resize" in buffer) {
    try {
      (buffer as { resize(length: number): void }).resize(0);
    } catch {
      // Not resizable, or detached.
    }
  }
  return array;
}

const handlers: ProxyHandler<object>[] = [
  {},
  { get: (target, name) => Reflect.get(target, name) },
  { get: fail },
  { ownKeys: fail },
  { getPrototypeOf: fail },
  { getOwnPropertyDescriptor: fail },
  { has: () => true, get: () => 7 },
  { get: (_, name) => (name === "length" ? 2 ** 40 : undefined) },
];

/** A proxy of an object, forwarding or hostile. */
export function proxied(random: Random, target: object): object {
  if (random.between(0, 1) < 0.1) {
    const { proxy, revoke } = Proxy.revocable(target, {});
    revoke();
    return proxy;
  }
  return new Proxy(target, pick(random, handlers));
}

function cyclic(): object {
  const [object, list]: [Record<string, unknown>, unknown[]] = [{}, []];
  object.self = object;
  object.list = list;
  list.push(list, object);
  return object;
}

function deep(levels: number): unknown {
  let value: unknown = 1;
  for (let i = 0; i < levels; i++) value = i % 2 === 0 ? [value] : { value };
  return value;
}

const makers: ((random: Random) => unknown)[] = [
  () => undefined,
  () => null,
  (random) => random.between(0, 1) < 0.5,
  (random) => pick(random, numbers),
  (random) => pick(random, texts),
  () => 5n,
  () => Symbol("odd"),
  () => fail,
  () => WithAccessors,
  () => ({}),
  () => [],
  (random) => random.list(random.whole(0, 20), -2, 2),
  (random) => [oddValue(random), oddValue(random)],
  (random) => ({ data: oddValue(random), width: pick(random, numbers), height: oddValue(random) }),
  () => Object.create(null),
  () => Object.create({ width: 5 }),
  () => new WithAccessors(),
  () => Object.freeze({ scale: 1 }),
  () => ({ constructor: null, toString: null }),
  () => ({ toString: fail, valueOf: fail, [Symbol.toPrimitive]: fail }),
  () => ({ [Symbol.toStringTag]: "Float32Array" }),
  () => ({ [Symbol.toStringTag]: "Blob" }),
  () => ({ [Symbol.toStringTag]: "AbortSignal", aborted: false }),
  () => Object.defineProperty({}, Symbol.toStringTag, { get: fail }),
  () => Object.defineProperty({}, "width", { enumerable: true, get: fail }),
  // biome-ignore lint/suspicious/noThenProperty: a promise that never settles must not stop a call.
  () => ({ then: () => {} }),
  () => Promise.resolve(1),
  () => new Date(Number.NaN),
  () => new Map([["width", 1]]),
  () => new Error("an error"),
  () => /x/,
  () => new (class Sparse extends Array {})(5),
  () => cyclic(),
  () => deep(30),
  () => deep(20_000),
  oddArray,
  oddArray,
  (random) => oddArray(random).buffer,
  // A view into the memory that Node shares between buffers.
  () => Buffer.from("neither JSON nor glTF"),
  () => new DataView(new ArrayBuffer(16)),
  () => new Blob([new Uint8Array(8)]),
  () => new AbortController().signal,
  (random) => proxied(random, oddArray(random)),
  (random) => proxied(random, { width: 1 }),
  (random) => proxied(random, [1, 2, 3]),
  (random) => proxied(random, new ArrayBuffer(8)),
];

/** Any value. */
export const oddValue = (random: Random): unknown => pick(random, makers)(random);
