/** Changes of an argument: other types, getters, proxies, detached and shared memory. */
import type { Random } from "../random.js";
import { detach, oddArray, oddValue, pick, proxied, Thrown } from "./odd-values.js";

/** A plain object. */
export type Fields = Record<string, unknown>;

/** A property somewhere in an object. */
interface Place {
  owner: Fields;
  name: string;
}

function isPlain(value: unknown): value is Fields {
  try {
    return typeof value === "object" && value !== null && Object.getPrototypeOf(value) === Object.prototype;
  } catch {
    // A hostile proxy.
    return false;
  }
}

/** All properties of an object, and of the plain objects in it. Some of them contain themselves. */
function places(owner: Fields, levels = 4): Place[] {
  return properties(owner).flatMap(([name, { value }]) => [
    { owner, name },
    ...(isPlain(value) && levels > 0 ? places(value, levels - 1) : []),
  ]);
}

function properties(owner: Fields): [name: string, descriptor: PropertyDescriptor][] {
  try {
    return Object.entries(Object.getOwnPropertyDescriptors(owner));
  } catch {
    return [];
  }
}

const names = [
  "width",
  "depthScale",
  "depthKind",
  "focalUncertainty",
  "mask",
  "K",
  "fovYDeg",
  "data",
  "format",
  "constructor",
  "__proto__",
  "counts",
];

const set = ({ owner, name }: Place, value: unknown) =>
  Object.defineProperty(owner, name, { value, enumerable: true, configurable: true, writable: true });

/** Changes something in an object. The object stays an ordinary one, whose properties can be changed again. */
export function mutate(random: Random, input: object): void {
  const all = isPlain(input) ? places(input) : [];
  if (all.length === 0) return;
  const place = pick(random, all);
  // Nothing, if an earlier change made it a getter.
  const value: unknown = Object.getOwnPropertyDescriptor(place.owner, place.name)?.value;
  const changes: (() => unknown)[] = [
    () => set(place, oddValue(random)),
    () => set(place, oddValue(random)),
    () => set(place, oddArray(random)),
    () => delete place.owner[place.name],
    () => set({ owner: place.owner, name: pick(random, names) }, oddValue(random)),
    () => typeof value === "object" && value !== null && set(place, proxied(random, value)),
    () => ArrayBuffer.isView(value) && detach(value),
    () => ArrayBuffer.isView(value) && set(place, onSharedMemory(value)),
    () => ArrayBuffer.isView(value) && set(place, ownBuffer(value)),
    () => ArrayBuffer.isView(value) && set(place, Array.from(value as Uint8Array).slice(0, 300)),
    () => getter(place, random, value),
  ];
  try {
    pick(random, changes)();
  } catch {
    // What cannot be changed, such as a frozen object, stays as it is.
  }
}

/** A getter that throws, or whose value changes. */
function getter(place: Place, random: Random, value: unknown): void {
  const throws = random.between(0, 1) < 0.5;
  const later = oddValue(random);
  let isFirst = true;
  const get = () => {
    if (throws) throw new Thrown("thrown by a getter");
    const given = isFirst ? value : later;
    isFirst = false;
    return given;
  };
  Object.defineProperty(place.owner, place.name, { get, enumerable: true, configurable: true });
}

/** The bytes of an array alone: the memory of small buffers of Node contains others. */
const ownBuffer = ({ buffer, byteOffset, byteLength }: ArrayBufferView) =>
  buffer.slice(byteOffset, byteOffset + byteLength);

function onSharedMemory(array: ArrayBufferView): unknown {
  const shared = new SharedArrayBuffer(array.byteLength);
  new Uint8Array(shared).set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
  const Kind = array.constructor as new (buffer: SharedArrayBuffer) => unknown;
  return array instanceof Uint8Array ? new Uint8Array(shared) : new Kind(shared);
}
